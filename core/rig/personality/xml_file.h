#pragma once
/// A well-formed XML document of limited size, with the position of its nodes. Private to core/rig.

#include <memory>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>

#include "core/result.h"
#include "core/rig/problem_list.h"

namespace luxrig {

inline constexpr std::size_t kMaxXmlBytes = std::size_t{32} << 20;
inline constexpr int kMaxXmlDepth = 100;

class XmlFile {
 public:
  /// Refuses, with its place, a text that is not well-formed UTF-8 XML, has a DOCTYPE (it could bring entities), or
  /// exceeds the limits above. `file` is for messages.
  [[nodiscard]] static Checked<XmlFile> parse(std::string_view text, std::string file);

  [[nodiscard]] pugi::xml_node root() const { return document_->document_element(); }
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] FilePosition place_of(const pugi::xml_node& node) const;

 private:
  [[nodiscard]] FilePosition place_at(std::ptrdiff_t offset) const;
  std::shared_ptr<pugi::xml_document> document_;  ///< pugi's nodes point to it
  std::vector<std::size_t> line_starts_;
  std::string file_;
};

/// An attribute's text, made plain (plain_text.h) and trimmed; empty if absent.
[[nodiscard]] std::string plain_attribute(const pugi::xml_node& node, const char* name);

/// A finite number; `fallback` if the attribute is absent, empty or not a number.
[[nodiscard]] double number_attribute(const pugi::xml_node& node, const char* name, double fallback);

/// The whole text as a finite number.
[[nodiscard]] std::optional<double> finite_number(std::string_view text);

/// All numbers in {…}{…}; empty if it contains anything else, or if one is not finite.
[[nodiscard]] std::vector<double> numbers_in_braces(std::string_view text);

[[nodiscard]] std::string_view without_blanks(std::string_view text);

}  // namespace luxrig
