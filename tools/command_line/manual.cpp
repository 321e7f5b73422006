#include "tools/command_line/manual.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "tools/command_line/help.h"

namespace luxrig {
namespace {

std::vector<const CLI::App*> commands_in(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

/// Text escaped for man(7).
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

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::string heading(const std::string& name, const std::string& summary) {
  return fmt::format(".TH {} 1 \"\" \"Luxrig {}\"\n.SH NAME\n{} \\- {}\n", upper(roff(name)), LUXRIG_VERSION,
                     roff(name), roff(summary));
}

/// The end of every page.
std::string ending(const CLI::App& app) {
  std::string page;
  if (!app.get_footer().empty()) page += ".SH MORE\n.nf\n" + roff(app.get_footer()) + "\n.fi\n";
  return page +
         ".SH EXIT STATUS\n.TP\n0\ndone\n.TP\n1\nthe world failed, or goals were not met\n.TP\n2\nbad input; nothing "
         "has moved\n";
}

/// words: the words before the options: "luxrig check".
std::string page_of_one(const CLI::App& app, const std::string& name, const std::string& words) {
  std::string page = heading(name, app.get_description());
  const auto commands = commands_in(app);
  if (commands.empty()) {
    page += fmt::format(".SH SYNOPSIS\n.B {}\n.SH OPTIONS\n{}", roff(synopsis(app, words)), options_page(app));
    return page;
  }
  page += ".SH SYNOPSIS\n";
  for (const CLI::App* command : commands)
    page += fmt::format(".B {}\n.br\n", roff(synopsis(*command, words + " " + command->get_name())));
  page += ".SH COMMANDS\n";
  for (const CLI::App* command : commands) {
    page += fmt::format(".SS {}\n{}\n{}", roff(synopsis(*command, words + " " + command->get_name())),
                        roff(command->get_description()), options_page(*command));
  }
  return page;
}

}  // namespace

std::vector<ManPage> man_pages(const CLI::App& app) {
  const std::string& program = app.get_name();
  const auto commands = commands_in(app);
  if (commands.empty()) return {{program, page_of_one(app, program, program) + ending(app)}};
  std::string page = heading(program, app.get_description()) +
                     fmt::format(".SH SYNOPSIS\n.B {}\n.I COMMAND\n[arguments] [options]\n", roff(program));
  std::vector<ManPage> pages(1);
  std::string group;
  for (const CLI::App* command : commands) {
    if (command->get_group() != group) page += ".SH " + upper(roff(command->get_group())) + "\n";
    group = command->get_group();
    const std::string name = program + "-" + command->get_name();
    page += fmt::format(".TP\n.BR {} (1)\n{}\n", roff(name), roff(command->get_description()));
    if (command->get_help_ptr() == nullptr) continue;
    pages.push_back({name, page_of_one(*command, name, program + " " + command->get_name()) + ending(*command) +
                               fmt::format(".SH SEE ALSO\n.BR {} (1)\n", roff(program))});
  }
  pages.front() = {program, page + ".SH OPTIONS\n" + options_page(app) + ending(app)};
  return pages;
}

}  // namespace luxrig
