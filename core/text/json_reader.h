#pragma once
/// JSON documents that a person may have edited, such as plans and calibrations: every problem with its line and column.

#include <fmt/format.h>

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry.h"
#include "core/result.h"

namespace luxrig {

/// Reads typed members of a document and collects every problem with its path (/tasks/0/lights/3/level).
class JsonReader {
 public:
  using Json = nlohmann::json;
  static constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

  /// kind: of document, with its article ("a plan"). remedy: how a person gets a right one.
  JsonReader(std::string file_name, std::string kind, std::string remedy)
      : file_name_(std::move(file_name)), kind_(std::move(kind)), remedy_(std::move(remedy)) {}

  /// The document, an object; none if the text is too large, too deep, no JSON, or has a key twice in one object.
  [[nodiscard]] std::optional<Json> document(const std::string& text);
  /// All problems so far, each with its place in the text.
  [[nodiscard]] std::vector<Problem> problems(const std::string& text) const;
  [[nodiscard]] bool any_problem() const { return !problems_.empty(); }

  void problem(std::string what, std::string mend) const;
  void wrong_type(const std::string& path, const char* key, const char* wanted, const Json& value) const;

  /// The member, or null if absent (a problem if required).
  [[nodiscard]] const Json* member(const Json& object, const std::string& path, const char* key, bool required) const;
  /// A problem unless the member is this number.
  void require_version(const Json& object, const char* key, int version) const;
  [[nodiscard]] std::string text(const Json& object, const std::string& path, const char* key, bool required) const;
  /// NaN if absent, since the key of an unknown number is left out.
  [[nodiscard]] double number(const Json& object, const std::string& path, const char* key, bool required) const;
  [[nodiscard]] std::optional<double> optional_number(const Json& object, const std::string& path,
                                                      const char* key) const;
  /// A fingerprint in hex digits; 0 = none.
  [[nodiscard]] std::uint64_t fingerprint(const Json& object, const std::string& path, const char* key) const;
  /// Leaves `value` unchanged if the key is absent.
  void read_yes_no(const Json& object, const std::string& path, const char* key, bool& value) const;
  [[nodiscard]] std::optional<Vec3> vector(const Json& object, const std::string& path, const char* key) const;
  [[nodiscard]] std::optional<Eigen::Vector2d> pair(const Json& object, const std::string& path, const char* key) const;

  /// A whole number from 0; 0 if absent.
  template <class Unsigned>
  [[nodiscard]] Unsigned count(const Json& object, const std::string& path, const char* key) const {
    const Json* value = member(object, path, key, false);
    if (!value) return 0;
    if (value->is_number_unsigned() &&
        value->get<std::uint64_t>() <= static_cast<std::uint64_t>(std::numeric_limits<Unsigned>::max())) {
      return static_cast<Unsigned>(value->get<std::uint64_t>());
    }
    wrong_type(path, key, "a whole number from 0", *value);
    return 0;
  }

  /// Calls body(entry, path) for each object of the list.
  template <class Body>
  void each(const Json& object, const std::string& path, const char* key, bool required, Body body) const {
    const Json* list = member(object, path, key, required);
    if (!list) return;
    if (!list->is_array()) return wrong_type(path, key, "a list", *list);
    for (std::size_t i = 0; i < list->size(); ++i) {
      const std::string entry_path = fmt::format("{}/{}/{}", path, key, i);
      if ((*list)[i].is_object()) {
        body((*list)[i], entry_path);
      } else {
        problem(fmt::format("{} is {}, not an object", entry_path, (*list)[i].type_name()), remedy_);
      }
    }
  }

 private:
  template <int size>
  [[nodiscard]] std::optional<Eigen::Vector<double, size>> numbers(const Json& object, const std::string& path,
                                                                   const char* key, const char* wanted) const;

  std::string file_name_, kind_, remedy_;
  mutable std::vector<Problem> problems_;  // readers of parts take a const reader
};

}  // namespace luxrig
