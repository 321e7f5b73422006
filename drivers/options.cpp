#include "drivers/options.h"

#include <algorithm>
#include <charconv>

#include "core/check.h"
#include "core/rig/schema.h"
#include "core/text/nearest.h"

namespace luxrig {
namespace {

constexpr std::string_view kTo = " to ";

std::int64_t number_in(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  LUXRIG_CHECK(error == std::errc() && end == text.data() + text.size(), "option table: \"{}\" is no integer", text);
  return value;
}

std::pair<std::int64_t, std::int64_t> range_of(const OptionDoc& doc) {
  const auto split = doc.range.find(kTo);
  LUXRIG_CHECK(split != std::string_view::npos, "option table: range of {} is \"{}\"", doc.key, doc.range);
  return {number_in(doc.range.substr(0, split)), number_in(doc.range.substr(split + kTo.size()))};
}

std::string_view type_of(const OptionValue& value) {
  switch (value.index()) {
    case 0:
      return "true or false";
    case 1:
      return "whole number";
    case 2:
      return "number with a fraction";
    default:
      return "text";
  }
}

std::string with_article(std::string_view type) {
  const bool counts = type.find("number") != std::string_view::npos;
  return (counts ? "a " : "") + std::string(type);
}

std::string example_of(const OptionDoc& doc) {
  if (doc.fallback != kRequired) return "write " + std::string(doc.key) + " = " + std::string(doc.fallback);
  return "write " + std::string(doc.key) + " = …, " + std::string(doc.summary);
}

const OptionDoc& find(std::span<const OptionDoc> docs, std::string_view key, std::string_view type) {
  const auto found = std::find_if(docs.begin(), docs.end(), [&](const OptionDoc& doc) { return doc.key == key; });
  LUXRIG_CHECK(found != docs.end() && found->type == type, "option table: no {} \"{}\"", type, key);
  return *found;
}

const Option* find(const Bus& bus, std::string_view key) {
  const auto found = bus.options.find(std::string(key));
  return found == bus.options.end() ? nullptr : &found->second;
}

}  // namespace

Problem problem_at(const Rig& rig, const Bus& bus, std::string_view key, std::string what, std::string mend) {
  const Option* option = find(bus, key);
  const FilePosition in_file = option != nullptr ? option->in_file : bus.in_file;
  return {rig.file.string(), in_file.line, in_file.column, std::move(what), std::move(mend)};
}

std::vector<Problem> check_options(const Rig& rig, const Bus& bus, std::span<const OptionDoc> docs) {
  std::vector<Problem> problems;
  std::vector<std::string_view> known;
  for (const OptionDoc& doc : docs) known.push_back(doc.key);

  for (const auto& entry : bus.options) {
    const std::string& key = entry.first;
    const Option& option = entry.second;
    const auto doc = std::find_if(docs.begin(), docs.end(), [&](const OptionDoc& d) { return d.key == key; });
    if (doc == docs.end()) {
      problems.push_back(problem_at(rig, bus, key, "bus \"" + bus.name + "\" has an unknown option \"" + key + "\"",
                                    mend_for_unknown(key, known, "leave it out")));
      continue;
    }
    if (type_of(option.value) != doc->type) {
      problems.push_back(problem_at(
          rig, bus, key,
          key + " is " + with_article(type_of(option.value)) + " where " + with_article(doc->type) + " is wanted",
          example_of(*doc)));
      continue;
    }
    if (doc->type == "whole number") {
      const auto [lowest, highest] = range_of(*doc);
      const std::int64_t value = std::get<std::int64_t>(option.value);
      if (value < lowest || value > highest) {
        problems.push_back(problem_at(rig, bus, key, key + " = " + std::to_string(value) + " is out of range",
                                      "choose a value in " + std::string(doc->range)));
      }
    }
  }
  for (const OptionDoc& doc : docs) {
    if (doc.fallback == kRequired && find(bus, doc.key) == nullptr) {
      problems.push_back(problem_at(rig, bus, doc.key,
                                    "bus \"" + bus.name + "\" lacks the option \"" + std::string(doc.key) + "\"",
                                    example_of(doc)));
    }
  }
  return problems;
}

std::vector<std::string> list_in(std::string_view text) {
  std::vector<std::string> entries;
  if (text.find_first_not_of(' ') == std::string_view::npos) return entries;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    std::string_view entry = text.substr(from, comma - from);
    entry.remove_prefix(std::min(entry.find_first_not_of(' '), entry.size()));
    entry = entry.substr(0, entry.find_last_not_of(' ') + 1);
    entries.emplace_back(entry);
    from = comma + 1;
  }
  return entries;
}

std::string string_option(const Bus& bus, std::span<const OptionDoc> docs, std::string_view key) {
  const OptionDoc& doc = find(docs, key, "text");
  if (const Option* option = find(bus, key)) return std::get<std::string>(option->value);
  LUXRIG_CHECK(doc.fallback.size() >= 2, "option table: {} has no fallback", key);
  return std::string(doc.fallback.substr(1, doc.fallback.size() - 2));  // without its quotes
}

std::int64_t integer_option(const Bus& bus, std::span<const OptionDoc> docs, std::string_view key) {
  const OptionDoc& doc = find(docs, key, "whole number");
  if (const Option* option = find(bus, key)) return std::get<std::int64_t>(option->value);
  return number_in(doc.fallback);
}

bool boolean_option(const Bus& bus, std::span<const OptionDoc> docs, std::string_view key) {
  const OptionDoc& doc = find(docs, key, "true or false");
  if (const Option* option = find(bus, key)) return std::get<bool>(option->value);
  return doc.fallback == "true";
}

}  // namespace luxrig
