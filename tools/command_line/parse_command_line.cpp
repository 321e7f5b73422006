#include "tools/command_line/parse_command_line.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <string_view>
#include <vector>

#include "core/text/nearest.h"
#include "tools/command_line/completion.h"
#include "tools/command_line/help.h"
#include "tools/command_line/manual.h"

namespace luxrig {
namespace {

constexpr int kFailed = 1, kBadInput = 2;

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

/// Options of the command itself, without its subcommands.
std::vector<std::string> options_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

std::string nearest_of(const std::string& wanted, const std::vector<std::string>& known) {
  const std::vector<std::string_view> views(known.begin(), known.end());
  return mend_for_unknown(wanted, views, "it takes none");
}

/// "luxrig rdm list".
std::string whole_name(const CLI::App& app) {
  return app.get_parent() == nullptr ? app.get_name() : whole_name(*app.get_parent()) + " " + app.get_name();
}

const CLI::App& command_meant(const CLI::App& app, std::span<const std::string> words) {
  for (const CLI::App* command : commands_of(app))
    for (std::size_t i = 0; i < words.size(); ++i)
      if (words[i] == command->get_name()) return command_meant(*command, words.subspan(i + 1));
  return app;
}

/// Writes each page to its file in the folder, which exists.
int write_man_pages(const CLI::App& app, const std::filesystem::path& folder) {
  for (const ManPage& page : man_pages(app)) {
    const auto file = folder / (page.name + ".1");
    std::ofstream out(file, std::ios::binary);
    out << page.text;
    out.close();
    if (!out) {
      fmt::print(stderr, "{}: cannot be written\n", file.string());
      return kFailed;
    }
  }
  return 0;
}

/// Options for other programs, which help leaves out: the shell that completes a line, and the build of the man pages.
std::optional<int> answer_a_tool(CLI::App& app, std::span<const std::string> words) {
  if (words.empty()) return std::nullopt;
  if (words[0] == "--complete") {
    fmt::print("{}", offer_text(offer_for(app, words.subspan(1))));
    return 0;
  }
  if (words.size() != 2) return std::nullopt;
  if (words[0] == "--man-pages") return write_man_pages(app, words[1]);
  if (words[0] == "--completion") {
    for (const auto& [name, shell] : shells()) {
      if (name != words[1]) continue;
      fmt::print("{}", completion_script(app.get_name(), shell));
      return 0;
    }
  }
  return std::nullopt;
}

}  // namespace

void begin_command_line(CLI::App& app) { app.option_defaults()->always_capture_default(); }

std::string mend_of(const CLI::App& app, std::span<const std::string> words) {
  const CLI::App* command = &app;
  int places = 0;  // positional words so far
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "--") return "";
    if (word.size() > 1 && word[0] == '-' && (word[1] == '-' || std::isalpha(static_cast<unsigned char>(word[1])))) {
      const bool is_long = word[1] == '-';
      const std::string name = is_long ? word.substr(0, word.find('=')) : word.substr(0, 2);
      const CLI::Option* option = command->get_option_no_throw(name);
      if (option == nullptr) {
        return fmt::format("{}: there is no option \"{}\": {}", whole_name(*command), name,
                           nearest_of(name, options_of(*command)));
      }
      const bool value_inside = word.size() > name.size();
      if (!value_inside) i += static_cast<std::size_t>(std::max(0, option->get_items_expected_min()));
      continue;
    }
    int most = 0;
    for (const CLI::Option* option : command->get_options())
      if (option->get_positional()) most += option->get_items_expected_max();
    if (const auto commands = commands_of(*command); !commands.empty()) {
      const CLI::App* found = nullptr;
      std::vector<std::string> known;
      for (const CLI::App* one : commands) {
        if (one->get_name() == word) found = one;
        known.push_back(one->get_name());
      }
      if (found == nullptr && places < most) {  // its own, before the command: accounts RIG add
        ++places;
        continue;
      }
      if (found == nullptr) {
        return fmt::format("{}: there is no command \"{}\": {}", whole_name(*command), word, nearest_of(word, known));
      }
      command = found;
      places = 0;
      continue;
    }
    if (++places > most) {
      return fmt::format("{0}: \"{1}\" is too much: `{0} --help` tells what it takes", whole_name(*command), word);
    }
  }
  return "";
}

std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv) {
  tell_help_in_words(app);
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (const auto end = answer_a_tool(app, words)) return end;
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {
      app.exit(error);
      return 0;
    }
    const std::string mend = mend_of(app, words);
    if (!mend.empty()) {
      fmt::print(stderr, "{}\n", mend);
    } else {
      const CLI::App& command = command_meant(app, words);
      const bool bare = !commands_of(command).empty();
      fmt::print(stderr, "{0}: {1}: `{0} --help` tells all\n", whole_name(command),
                 bare ? "say which command" : error.what());
    }
    return kBadInput;
  }
}

}  // namespace luxrig
