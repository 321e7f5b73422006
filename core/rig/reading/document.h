#pragma once
/// A TOML text as a plain tree in which every value knows its line and column. The only file of the project that
/// sees toml++ is document.cpp.

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/result.h"
#include "core/rig/rig.h"

namespace luxrig {

struct Node;
struct Member;
using NodeList = std::vector<Node>;
using NodeTable = std::vector<Member>;  ///< sorted by key; keys are unique
struct DateOrTime {};                   ///< no key of a rig takes one

struct Node {
  std::variant<bool, std::int64_t, double, std::string, NodeList, NodeTable, DateOrTime> value;
  Place place;
};

struct Member {
  std::string key;
  Place key_place;
  Node node;
};

/// Nothing when the table has no such key.
[[nodiscard]] const Member* find(const NodeTable& table, std::string_view key);

/// What a person calls a value of this type: "a number", "text in quotes" …
[[nodiscard]] const char* kind_of(const Node& node);

/// The root table. Refuses what is not TOML, and nesting deeper than any rig needs (it would only serve to exhaust
/// the stack). `file_name` is only for problems.
[[nodiscard]] Checked<NodeTable> parse_document(std::string_view text, const std::string& file_name);

}  // namespace luxrig
