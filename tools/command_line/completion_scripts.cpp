// The script with which each shell asks the program: the same few lines, in its own language.
#include <algorithm>
#include <string_view>

#include "tools/command_line/completion.h"

namespace luxrig {
namespace {

// PROGRAM and FUNCTION are replaced.

constexpr std::string_view kBash = R"(# PROGRAM's completion for bash.
_FUNCTION() {
  local typed=${COMP_WORDS[COMP_CWORD]} places='' word
  [[ $typed == '=' ]] && typed=''
  COMPREPLY=()
  {
    read -r places
    while IFS=$'\t' read -r word _; do
      [[ $word == "$typed"* ]] && COMPREPLY+=("$word")
    done
  } < <("${COMP_WORDS[0]/#\~/$HOME}" --complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
  case $places in
    files)
      # Where nothing else fits, bash offers files by itself.
      if ((${#COMPREPLY[@]})); then
        compopt -o filenames 2>/dev/null
        while read -r word; do COMPREPLY+=("$word"); done < <(compgen -f -- "$typed")
      fi
      ;;
    folders) compopt +o default -o dirnames 2>/dev/null ;;
    *) compopt +o default 2>/dev/null ;;
  esac
}
complete -o default -F _FUNCTION PROGRAM
)";

constexpr std::string_view kZsh = R"(#compdef PROGRAM
# PROGRAM's completion for zsh.
_PROGRAM() {
  local -a answer told
  local line places
  answer=("${(@f)$("${(Q)words[1]/#\~/$HOME}" --complete "${(@Q)words[2,CURRENT]}" 2>/dev/null)}")
  places=$answer[1]
  for line in "${(@)answer[2,-1]}"; do
    told+=("${${line%%$'\t'*}//:/\\:}:${line#*$'\t'}")
  done
  [[ $PREFIX == --*=* ]] && compset -P '*='
  local found=1
  (($#told)) && _describe -V PROGRAM told && found=0
  case $places in
    files) _files && found=0 ;;
    folders) _files -/ && found=0 ;;
  esac
  return found
}
if [[ $funcstack[1] == _PROGRAM ]]; then
  _PROGRAM "$@"
else
  compdef _PROGRAM PROGRAM
fi
)";

constexpr std::string_view kFish = R"(# PROGRAM's completion for fish.
function __FUNCTION_offers
  set -l words (commandline -opc)
  set -l typed (commandline -ct)
  set -l answer ($words[1] --complete $words[2..-1] "$typed" 2>/dev/null)
  set -l before (string match -r -- '^--[^=]*=' "$typed")
  set -l rest (string replace -r -- '^--[^=]*=' '' "$typed")
  for line in $answer[2..-1]
    echo -- "$before$line"
  end
  switch "$answer[1]"
    case files
      for path in (__fish_complete_path "$rest")
        echo -- "$before$path"
      end
    case folders
      for path in (__fish_complete_directories "$rest" '')
        echo -- "$before$path"
      end
  end
end
complete -c PROGRAM -f -a '(__FUNCTION_offers)'
)";

void replace_all(std::string& text, std::string_view what, const std::string& by) {
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
}

}  // namespace

std::string completion_script(const std::string& program, Shell shell) {
  std::string function = program;
  std::replace(function.begin(), function.end(), '-', '_');
  std::string script(shell == Shell::bash ? kBash : shell == Shell::zsh ? kZsh : kFish);
  replace_all(script, "FUNCTION", function);
  replace_all(script, "PROGRAM", program);
  return script;
}

}  // namespace luxrig
