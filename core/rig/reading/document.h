#pragma once
/// A TOML text as a plain tree, where every value has its line and column. Only document.cpp includes toml++.

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/result.h"
#include "core/rig/scene_spec.h"

namespace luxrig {

struct Node;
struct Member;
using NodeList = std::vector<Node>;
using NodeTable = std::vector<Member>;  ///< sorted by key; keys are unique
struct DateOrTime {};                   ///< no key of a rig takes one

struct Node {
  std::variant<bool, std::int64_t, double, std::string, NodeList, NodeTable, DateOrTime> value;
  FilePosition in_file;
};

struct Member {
  std::string key;
  FilePosition key_place;
  Node node;
};

/// Null if the table has no such key.
[[nodiscard]] const Member* find(const NodeTable& table, std::string_view key);

/// Plain name for a value of this type: "a number", "text in quotes" …
[[nodiscard]] const char* kind_of(const Node& node);

/// The root table. Refuses a text that is not TOML, and nesting deeper than any rig needs (it could only exhaust the
/// stack). `file_name` is for problems only.
[[nodiscard]] Checked<NodeTable> parse_document(std::string_view text, const std::string& file_name);

}  // namespace luxrig
