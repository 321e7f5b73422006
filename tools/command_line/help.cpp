#include "tools/command_line/help.h"

#include <fmt/format.h>

#include <regex>

namespace luxrig {
namespace {

constexpr std::size_t kLeft = 26, kLeftOfCommands = 12, kLine = 80;

/// Breaks at spaces, so that no line of `text` is longer than `width`.
std::string wrapped(const std::string& text, std::size_t width, const std::string& between) {
  std::string all;
  std::size_t in_line = 0;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (in_line > 0 && in_line + 1 + word.size() > width) {
      all += between;
      in_line = 0;
    } else if (in_line > 0) {
      all += ' ';
      ++in_line;
    }
    all += word;
    in_line += word.size();
  }
  return all;
}

std::string two_columns(const std::string& left, const std::string& right, std::size_t width = kLeft) {
  const std::string indent = "\n" + std::string(width + 2, ' ');
  const std::string told = wrapped(right, kLine - width - 2, indent);
  if (left.size() + 2 > width) return "  " + left + indent + told + "\n";
  return fmt::format("  {:<{}}{}\n", left, width, told);
}

class InWords : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool) const override {
    return two_columns(option_names(*option), option_in_words(*option));
  }
  std::string make_subcommand(const CLI::App* command) const override {
    return two_columns(command->get_name(), command->get_description(), kLeftOfCommands);
  }
  std::string make_description(const CLI::App* app) const override {
    return wrapped(app->get_description(), kLine, "\n") + "\n";
  }
  std::string make_usage(const CLI::App* app, std::string name) const override {
    // The program's name without its folder.
    return Formatter::make_usage(app, name.substr(name.rfind('/') + 1));
  }
};

/// A number as short as it can be and still exact enough for a person.
std::string number_text(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return end != text.c_str() && *end == '\0' ? fmt::format("{:g}", value) : text;
}

}  // namespace

std::string values_in_words(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  std::smatch found;
  static const std::regex range(R"(in \[([^ ]+) - ([^ \]]+)\])"), choice(R"(:one of ([^:]+))");
  if (std::regex_search(type, found, choice)) return found[1];
  if (std::regex_search(type, found, range)) return number_text(found[1]) + " to " + number_text(found[2]);
  if (type.find("POSITIVE") != std::string::npos) return "above 0";
  return "";
}

std::string option_in_words(const CLI::Option& option) {
  std::string text = option.get_description();
  const auto add = [&text](const std::string& more) {
    if (!more.empty()) text += (text.empty() ? "" : "; ") + more;
  };
  add(values_in_words(option));
  if (!option.get_positional() && option.get_required()) add("required");
  const std::string standard = option.get_default_str();
  if (standard != "" && standard != "\"\"" && standard != "[]" && standard != "{}" &&
      option.get_items_expected_min() > 0)
    add("default " + number_text(standard));
  return text;
}

std::string option_names(const CLI::Option& option) {
  if (option.get_positional()) return option.get_name(true);
  std::string names;
  for (const std::string& name : option.get_snames()) names += (names.empty() ? "-" : ", -") + name;
  for (const std::string& name : option.get_lnames()) names += (names.empty() ? "--" : ", --") + name;
  if (option.get_items_expected_min() == 0) return names;
  const std::string type = option.get_type_name();
  const bool number = type.starts_with("INT") || type.starts_with("UINT") || type.starts_with("FLOAT");
  const bool word = type.find(":one of ") != std::string::npos;
  for (int i = 0; i < option.get_items_expected_min(); ++i) names += number ? " N" : word ? " WORD" : " TEXT";
  return names;
}

void tell_help_in_words(CLI::App& app) {
  app.formatter(std::make_shared<InWords>());
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) tell_help_in_words(*command);
}

}  // namespace luxrig
