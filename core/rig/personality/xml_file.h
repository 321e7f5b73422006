#pragma once
/// A well-formed, bounded XML document, and where its nodes stand. Private to core/rig.

#include <memory>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>

#include "core/result.h"
#include "core/rig/problem_list.h"

namespace luxrig {

inline constexpr std::size_t kMostXmlBytes = std::size_t{32} << 20;
inline constexpr int kMostXmlDepth = 100;

class XmlFile {
 public:
  /// Refuses, with its place, what is not well-formed UTF-8 XML, has a DOCTYPE (entities could come with it), is nested
  /// deeper or is larger than stated above. `file` is for the messages.
  [[nodiscard]] static Checked<XmlFile> parse(std::string_view text, std::string file);

  [[nodiscard]] pugi::xml_node root() const { return document_->document_element(); }
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] Place place_of(const pugi::xml_node& node) const;

 private:
  [[nodiscard]] Place place_at(std::ptrdiff_t offset) const;
  std::shared_ptr<pugi::xml_document> document_;  ///< pugi's nodes point to it
  std::vector<std::size_t> line_starts_;
  std::string file_;
};

/// An attribute's text, plain (plain_text.h), without blanks at its ends; empty when it is absent.
[[nodiscard]] std::string plain_attribute(const pugi::xml_node& node, const char* name);

/// A finite number; `fallback` when the attribute is absent, empty or no number.
[[nodiscard]] double number_attribute(const pugi::xml_node& node, const char* name, double fallback);

/// The whole of a text as a finite number.
[[nodiscard]] std::optional<double> finite_number(std::string_view text);

/// All numbers in {…}{…}; empty when anything else stands there, or one is not finite.
[[nodiscard]] std::vector<double> numbers_in_braces(std::string_view text);

[[nodiscard]] std::string_view without_blanks(std::string_view text);

}  // namespace luxrig
