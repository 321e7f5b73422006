#include "tools/command_line/manual.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <vector>

#include "tools/command_line/help.h"

namespace luxrig {
namespace {

std::vector<const CLI::App*> commands_in(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

/// Text as man(7) takes it.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  // A line that begins with one of these would be a request.
  if (!out.empty() && (out[0] == '.' || out[0] == '\'')) out.insert(0, "\\&");
  return out;
}

std::string options_page(const CLI::App& app) {
  std::string page;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_name() == "--help" || option->get_group().empty()) continue;
    page += fmt::format(".TP\n.B {}\n{}\n", roff(option_names(*option)), roff(option_in_words(*option)));
  }
  return page;
}

std::string synopsis(const CLI::App& app, const std::string& name) {
  std::string text = name;
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_positional()) continue;
    const std::string more = option->get_items_expected_max() > 1 ? "..." : "";
    text += option->get_required() ? " " + option->get_name(true) + more : " [" + option->get_name(true) + more + "]";
  }
  return text + " [options]";
}

std::string command_page(const CLI::App& app, const std::string& name) {
  const auto commands = commands_in(app);
  std::string page;
  if (!commands.empty()) {
    for (const CLI::App* command : commands) page += command_page(*command, name + " " + command->get_name());
    return page;
  }
  page = fmt::format(".SS {}\n{}\n", roff(synopsis(app, name)), roff(app.get_description()));
  return page + options_page(app);
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

/// The words of an option that is chosen from some; empty otherwise.
std::string choices_of(const CLI::Option& option) {
  if (option.get_type_name().find(":one of ") == std::string::npos) return "";
  std::string values = values_in_words(option);
  if (const auto last = values.rfind(" or "); last != std::string::npos) values.replace(last, 4, ", ");
  values.erase(std::remove(values.begin(), values.end(), ','), values.end());
  return values;
}

/// Lines of the three `case` statements, for a command and those in it.
struct Completion {
  std::string paths, values, words;
};

void complete(const CLI::App& app, const std::string& path, Completion& out) {
  std::string names, options;
  for (const CLI::App* command : commands_in(app)) {
    names += command->get_name() + " ";
    out.paths += fmt::format("      '{} {}') path=\"$path $one\" ;;\n", path, command->get_name());
    complete(*command, path + " " + command->get_name(), out);
  }
  for (const CLI::Option* option : app.get_options()) {
    const std::string choices = choices_of(*option);
    if (option->get_positional() && !choices.empty()) names += choices + " ";
    for (const std::string& name : option->get_lnames()) {
      options += "--" + name + " ";
      if (!choices.empty()) out.values += fmt::format("    '{} --{}') names='{}' ;;\n", path, name, choices);
    }
  }
  out.words += fmt::format("    '{}') names='{}' options='{}' ;;\n", path, names, options);
}

}  // namespace

std::string man_page(const CLI::App& app) {
  const std::string& name = app.get_name();
  std::string page = fmt::format(".TH {} 1 \"\" \"Luxrig {}\"\n.SH NAME\n{} \\- {}\n", upper(roff(name)),
                                 LUXRIG_VERSION, roff(name), roff(app.get_description()));
  const auto commands = commands_in(app);
  if (commands.empty()) {
    page += fmt::format(".SH SYNOPSIS\n.B {}\n.SH OPTIONS\n{}", roff(synopsis(app, name)), options_page(app));
  } else {
    page += fmt::format(".SH SYNOPSIS\n.B {}\n.I COMMAND\n[arguments] [options]\n", roff(name));
    std::vector<std::string> groups;
    for (const CLI::App* command : commands)
      if (std::find(groups.begin(), groups.end(), command->get_group()) == groups.end())
        groups.push_back(command->get_group());
    for (const std::string& group : groups) {
      page += ".SH " + upper(roff(group)) + "\n";
      for (const CLI::App* command : commands)
        if (command->get_group() == group) page += command_page(*command, name + " " + command->get_name());
    }
  }
  if (!app.get_footer().empty()) page += ".SH MORE\n.nf\n" + roff(app.get_footer()) + "\n.fi\n";
  return page +
         ".SH EXIT STATUS\n.TP\n0\ndone\n.TP\n1\nthe world failed, or goals were not met\n.TP\n2\nbad input; nothing "
         "has moved\n";
}

std::string bash_completion(const CLI::App& app) {
  std::string function = "_" + app.get_name();
  std::replace(function.begin(), function.end(), '-', '_');
  Completion of;
  complete(app, app.get_name(), of);
  return fmt::format(R"(# Completion of {0} for bash. Where no word fits, files are offered.
{1}() {{
  local word="${{COMP_WORDS[COMP_CWORD]}}" last="${{COMP_WORDS[COMP_CWORD-1]}}" path={0} names='' options='' one
  for one in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case "$path $one" in
{2}      *) ;;
    esac
  done
  case "$path" in
{3}  esac
  case "$path $last" in
{4}    *) ;;
  esac
  [[ "$word" == -* ]] && names=$options
  COMPREPLY=($(compgen -W "$names" -- "$word"))
}}
complete -o default -F {1} {0}
)",
                     app.get_name(), function, of.paths, of.words, of.values);
}

}  // namespace luxrig
