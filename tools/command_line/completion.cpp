#include "tools/command_line/completion.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/command_line/choice.h"
#include "tools/command_line/installed.h"

namespace luxrig {
namespace {

constexpr const char *kOffersFiles = "files", *kOffersFolders = "folders";

CLI::Validator takes_any(const char* name) {
  return {[](std::string&) { return std::string(); }, "", name};
}

bool is_marked(CLI::Option& option, const char* name) {
  try {
    option.get_validator(name);
    return true;
  } catch (const CLI::OptionNotFound&) {
    return false;
  }
}

Offer values_of(CLI::Option& option) {
  Offer offer;
  for (std::string& word : words_to_choose(option)) offer.words.push_back({std::move(word), ""});
  if (is_marked(option, kOffersRigs)) {
    for (std::string& name : shipped_rigs()) offer.words.push_back({std::move(name), "a rig that came with Luxrig"});
    offer.places = Offer::Places::files;
  }
  if (is_marked(option, kOffersFiles)) offer.places = Offer::Places::files;
  if (is_marked(option, kOffersFolders)) offer.places = Offer::Places::folders;
  return offer;
}

Offer options_offered(const CLI::App& command) {
  Offer offer;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group().empty()) continue;
    for (const std::string& name : option->get_lnames())
      offer.words.push_back({"--" + name, option->get_description()});
    if (!option->get_lnames().empty()) continue;
    for (const std::string& name : option->get_snames()) offer.words.push_back({"-" + name, option->get_description()});
  }
  return offer;
}

/// The option of the positional word that follows `before` others.
CLI::Option* positional_after(CLI::App& command, int before) {
  for (CLI::Option* option : command.get_options()) {
    if (!option->get_positional()) continue;
    before -= std::min(before + 1, option->get_items_expected_max());
    if (before < 0) return option;
  }
  return nullptr;
}

/// State after the words before the one being typed.
struct Reached {
  CLI::App* command;
  int places = 0;                  ///< positional words of this command so far
  CLI::Option* waiting = nullptr;  ///< option whose values follow
  int values_left = 0;
  bool only_places = false;  ///< after "--"

  void step(const std::string& word) {
    if (values_left > 0) {
      // bash splits "--name=value".
      if (word != "=" && --values_left == 0) waiting = nullptr;
    } else if (word == "--") {
      only_places = true;
    } else if (!only_places && word.size() > 1 && word[0] == '-') {
      const bool is_long = word[1] == '-';
      const std::string name = is_long ? word.substr(0, word.find('=')) : word.substr(0, 2);
      CLI::Option* option = command->get_option_no_throw(name);
      if (option == nullptr || word.size() > name.size()) return;
      values_left = std::max(0, option->get_items_expected_min());
      waiting = values_left > 0 ? option : nullptr;
    } else if (const auto inner =
                   command->get_subcommands([&](const CLI::App* one) { return one->get_name() == word; });
               !inner.empty()) {
      command = inner.front();
      places = 0;
    } else {
      ++places;
    }
  }
};

}  // namespace

std::vector<std::pair<std::string, Shell>> shells() {
  return {{"bash", Shell::bash}, {"zsh", Shell::zsh}, {"fish", Shell::fish}};
}

CLI::Validator offers_files() { return takes_any(kOffersFiles); }
CLI::Validator offers_folders() { return takes_any(kOffersFolders); }

Offer offer_for(CLI::App& app, std::span<const std::string> words) {
  if (words.empty()) return {};
  Reached reached{&app};
  for (const std::string& word : words.first(words.size() - 1)) reached.step(word);
  const std::string& typed = words.back();
  if (reached.waiting != nullptr) return values_of(*reached.waiting);
  if (!reached.only_places && typed.starts_with('-')) {
    if (const auto equals = typed.find('='); equals != std::string::npos) {
      CLI::Option* option = reached.command->get_option_no_throw(typed.substr(0, equals));
      return option != nullptr ? values_of(*option) : Offer{};
    }
    return options_offered(*reached.command);
  }
  if (const auto commands = reached.command->get_subcommands([](const CLI::App*) { return true; }); !commands.empty()) {
    Offer offer;
    for (const CLI::App* command : commands) offer.words.push_back({command->get_name(), command->get_description()});
    return offer;
  }
  CLI::Option* option = positional_after(*reached.command, reached.places);
  return option != nullptr ? values_of(*option) : Offer{};
}

std::string offer_text(const Offer& offer) {
  std::string text = offer.places == Offer::Places::files     ? "files\n"
                     : offer.places == Offer::Places::folders ? "folders\n"
                                                              : "none\n";
  for (const Offer::Word& word : offer.words) text += fmt::format("{}\t{}\n", word.text, word.told);
  return text;
}

}  // namespace luxrig
