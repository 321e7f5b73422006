#pragma once
/// XML elements by name without namespace prefix, and their text.

#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/photometry/files/file_text.h"
#include "core/rig/personality/xml_file.h"
#include "core/text/plain_text.h"

namespace luxrig {

[[nodiscard]] inline std::string_view local_name(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  const std::size_t colon = name.rfind(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

[[nodiscard]] inline std::vector<pugi::xml_node> children_called(const pugi::xml_node& parent, std::string_view name) {
  std::vector<pugi::xml_node> out;
  for (const pugi::xml_node& child : parent.children())
    if (child.type() == pugi::node_element && local_name(child) == name) out.push_back(child);
  return out;
}

[[nodiscard]] inline pugi::xml_node child_called(const pugi::xml_node& parent, std::string_view name) {
  for (const pugi::xml_node& child : parent.children())
    if (child.type() == pugi::node_element && local_name(child) == name) return child;
  return {};
}

/// Text of a child, made plain and trimmed; empty if there is no such child.
[[nodiscard]] inline std::string text_of_child(const pugi::xml_node& parent, std::string_view name) {
  return made_plain(without_blanks(child_called(parent, name).child_value()));
}

/// Whether the file starts as XML does, in UTF-8 or UTF-16.
[[nodiscard]] inline bool is_xml(std::string_view text) {
  const std::string head = file_text::from_utf16(text.substr(0, 64)).value_or(std::string(text.substr(0, 64)));
  return file_text::trimmed(file_text::without_bom(head)).starts_with('<');
}

}  // namespace luxrig
