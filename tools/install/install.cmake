# `cmake --install build/release` and `cpack --config build/release/CPackConfig.cmake`: programs, page, rigs with their
# register maps, man pages, completion, the systemd unit. Programs find the rest beside them, in ../share/luxrig.
include(GNUInstallDirs)

# The build folder is laid out like an installation.
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/share/luxrig)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/rigs ${CMAKE_BINARY_DIR}/share/luxrig/rigs SYMBOLIC)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/tools/luxrig-sim/page ${CMAKE_BINARY_DIR}/share/luxrig/sim-page SYMBOLIC)

# The programs write man pages and completion themselves, from their declared options. Only they know which pages there
# are, one for each command. The folder is cleared first, so pages of removed commands go.
set(manual ${CMAKE_BINARY_DIR}/manual)
set(manuals "")
foreach(program luxrig luxrig-bench luxrig-test luxrigd luxrig-sim)
  set(of_program ${manual}/${program})
  add_custom_command(
    OUTPUT ${of_program}/bash ${of_program}/zsh ${of_program}/fish
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${of_program}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${of_program}/man1
    COMMAND ${program} --man-pages ${of_program}/man1
    COMMAND ${program} --completion bash > ${of_program}/bash
    COMMAND ${program} --completion zsh > ${of_program}/zsh
    COMMAND ${program} --completion fish > ${of_program}/fish
    DEPENDS ${program}
    COMMENT "Man pages and completion of ${program}"
    VERBATIM)
  list(APPEND manuals ${of_program}/fish)
endforeach()
add_custom_target(manual DEPENDS ${manuals})
# Everything that `cmake --install` needs.
add_custom_target(installable DEPENDS luxrig luxrig-bench luxrig-test luxrigd luxrig-sim luxrig-guardian manual)
if(TARGET web)
  add_dependencies(installable web)
endif()

install(TARGETS luxrig luxrig-bench luxrig-test luxrigd luxrig-sim luxrig-guardian RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/rigs/ DESTINATION ${CMAKE_INSTALL_DATADIR}/luxrig/rigs)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/tools/luxrig-sim/page/ DESTINATION ${CMAKE_INSTALL_DATADIR}/luxrig/sim-page)
if(TARGET web)
  install(DIRECTORY ${LUXRIG_WEB_DIR}/ DESTINATION ${CMAKE_INSTALL_DATADIR}/luxrig/web)
endif()
# Debian's zsh reads completions of packages from another folder than those installed by hand.
install(CODE [[
  set(zsh_folder site-functions)
  if(CMAKE_INSTALL_PREFIX MATCHES "/usr$")
    set(zsh_folder vendor-completions)
  endif()
]])
foreach(program luxrig luxrig-bench luxrig-test luxrigd luxrig-sim)
  install(DIRECTORY ${manual}/${program}/man1/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES ${manual}/${program}/bash RENAME ${program}
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(FILES ${manual}/${program}/zsh RENAME _${program} DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/\${zsh_folder})
  install(FILES ${manual}/${program}/fish RENAME ${program}.fish
          DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
endforeach()
install(FILES ${CMAKE_CURRENT_LIST_DIR}/luxrigd@.service DESTINATION lib/systemd/system)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/BENCHMARKS.md
        DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME luxrig)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "sets a lighting rig to goals in lux, measures and corrects it")
set(CPACK_PACKAGE_DESCRIPTION "Reads a 3-D scene, the photometry of luminaires, what hangs where and goals in lux; computes
levels and aims; drives dimmers and moving heads over sACN, Art-Net, USB-DMX, Modbus and CAN; reads luxmeters and corrects
what the model got wrong. With a simulated rig that speaks the same protocols.")
set(CPACK_PACKAGE_CONTACT "the Luxrig authors <luxrig@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION electronics)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "fonts-dejavu-core")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/prerm)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
include(CPack)
