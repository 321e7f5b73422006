#include "core/rig/personality/xml_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/text/plain_text.h"

namespace luxrig {
namespace {

tl::unexpected<std::vector<Problem>> refuse_xml(const std::string& file, const FilePosition& in_file, std::string what,
                                                std::string mend) {
  return tl::unexpected(std::vector<Problem>{{file, in_file.line, in_file.column, std::move(what), std::move(mend)}});
}

/// The first node that is nested too deep, if any. No recursion, since the depth is not known yet.
pugi::xml_node too_deep(const pugi::xml_node& root) {
  int depth = 1;
  for (pugi::xml_node at = root; at;) {
    if (depth > kMaxXmlDepth) return at;
    if (at.first_child()) {
      at = at.first_child();
      ++depth;
      continue;
    }
    while (at && at != root && !at.next_sibling()) {
      at = at.parent();
      --depth;
    }
    if (at == root) break;
    at = at.next_sibling();
  }
  return {};
}

}  // namespace

Checked<XmlFile> XmlFile::parse(std::string_view text, std::string file) {
  XmlFile xml;
  xml.file_ = std::move(file);
  if (text.size() > kMaxXmlBytes) {
    return refuse_xml(xml.file_, {}, fmt::format("the XML has {} bytes", text.size()),
                      fmt::format("it may have at most {} MiB", kMaxXmlBytes >> 20));
  }
  xml.line_starts_.push_back(0);
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n') xml.line_starts_.push_back(i + 1);
  xml.document_ = std::make_shared<pugi::xml_document>();
  const pugi::xml_parse_result result = xml.document_->load_buffer(
      text.data(), text.size(), pugi::parse_default | pugi::parse_doctype, pugi::encoding_utf8);
  if (!result) {
    return refuse_xml(xml.file_, xml.place_at(result.offset),
                      fmt::format("the XML is not well-formed ({})", result.description()),
                      "export the file again from the program that made it");
  }
  for (const pugi::xml_node& node : xml.document_->children()) {
    if (node.type() == pugi::node_doctype)
      return refuse_xml(xml.file_, xml.place_of(node), "the XML has a DOCTYPE", "remove it: no such file needs one");
  }
  if (!xml.root()) return refuse_xml(xml.file_, {1, 1}, "the XML has no content", "export the file again");
  if (const pugi::xml_node deep = too_deep(xml.root())) {
    return refuse_xml(xml.file_, xml.place_of(deep), fmt::format("nested deeper than {}", kMaxXmlDepth),
                      "no such file needs that; do not trust it");
  }
  return xml;
}

FilePosition XmlFile::place_of(const pugi::xml_node& node) const { return place_at(node.offset_debug()); }

FilePosition XmlFile::place_at(std::ptrdiff_t offset) const {
  if (offset < 0) return {};
  const auto at = static_cast<std::size_t>(offset);
  const auto after = std::upper_bound(line_starts_.begin(), line_starts_.end(), at);
  return {static_cast<int>(after - line_starts_.begin()), static_cast<int>(at - *std::prev(after)) + 1};
}

std::string_view without_blanks(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

std::string plain_attribute(const pugi::xml_node& node, const char* name) {
  return made_plain(without_blanks(node.attribute(name).value()));
}

std::optional<double> finite_number(std::string_view text) {
  text = without_blanks(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

double number_attribute(const pugi::xml_node& node, const char* name, double fallback) {
  return finite_number(node.attribute(name).value()).value_or(fallback);
}

std::vector<double> numbers_in_braces(std::string_view text) {
  std::vector<double> numbers;
  while (!text.empty()) {
    const auto begin = text.find_first_not_of("{}, \t\r\n");
    if (begin == std::string_view::npos) break;
    const auto end = std::min(text.find_first_of("{}, \t\r\n", begin), text.size());
    const auto number = finite_number(text.substr(begin, end - begin));
    if (!number) return {};
    numbers.push_back(*number);
    text.remove_prefix(end);
  }
  return numbers;
}

}  // namespace luxrig
