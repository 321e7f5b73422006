#pragma once
/// Checks a bus's options against the table that documents them. Type, default and range are stated only in that table,
/// so reference and code cannot disagree.
///
///   type     "text", "whole number" or "true or false"
///   range    of a whole number: "lowest to highest"; of text: words for a person (the driver checks it)
///   fallback value when absent, as it would be written; "required" if there is none

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "drivers/registry.h"

namespace luxrig {

/// Reports unknown keys (with the nearest known one), wrong types, integers out of range, absent required keys.
[[nodiscard]] std::vector<Problem> check_options(const Rig& rig, const Bus& bus, std::span<const OptionDoc> docs);

/// The option's value, or its fallback. requires check_options() to be empty and `key` in `docs` with that type.
[[nodiscard]] std::string string_option(const Bus& bus, std::span<const OptionDoc> docs, std::string_view key);
[[nodiscard]] std::int64_t integer_option(const Bus& bus, std::span<const OptionDoc> docs, std::string_view key);
[[nodiscard]] bool boolean_option(const Bus& bus, std::span<const OptionDoc> docs, std::string_view key);

/// "a, b" -> {"a", "b"}; blanks around an entry are dropped. Empty text has no entries.
[[nodiscard]] std::vector<std::string> list_in(std::string_view text);

/// A problem located at the option if it is written, else at its bus.
[[nodiscard]] Problem problem_at(const Rig& rig, const Bus& bus, std::string_view key, std::string what,
                                 std::string mend);

}  // namespace luxrig
