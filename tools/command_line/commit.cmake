# Writes the file that defines luxrig::kVersion, at each build. Only a change rewrites it, so nothing else recompiles.
#   cmake -D SOURCE=FOLDER -D VERSION=0.1.0 -D OUTPUT=FILE -P commit.cmake
set(commit "")
find_program(GIT git)
if(GIT)
  # A prefix: the folder lies inside another repository, such as an unpacked tarball.
  execute_process(COMMAND ${GIT} -C ${SOURCE} rev-parse --show-prefix OUTPUT_VARIABLE prefix RESULT_VARIABLE failed
                  ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT failed AND prefix STREQUAL "")
    execute_process(COMMAND ${GIT} -C ${SOURCE} rev-parse --short HEAD OUTPUT_VARIABLE commit ERROR_QUIET
                    OUTPUT_STRIP_TRAILING_WHITESPACE)
  endif()
endif()
if(commit)
  # Without locks: a build must not disturb a commit that runs at the same time.
  execute_process(COMMAND ${GIT} --no-optional-locks -C ${SOURCE} status --porcelain --untracked-files=no
                  OUTPUT_VARIABLE changes ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(changes)
    string(APPEND commit "-dirty")
  endif()
  set(commit " (${commit})")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[// Written by tools/command_line/commit.cmake.
#include "tools/command_line/version.h"
const char* const luxrig::kVersion = "@VERSION@@commit@";
]])
