#pragma once
/// One table of the rig file, read key by key against the schema: type, range, required, unknown keys.
///
///   Section s(table, place, "control", problems);
///   s.read("fade_s", control.fade_s);   // keeps the default if the key is absent or wrong
///
/// Every read reports problems of its value, once. Using a key that is not in the schema, or reading it as another
/// type, is a bug of the reader (asserted).

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/rig/problem_list.h"
#include "core/rig/reading/document.h"
#include "core/rig/schema.h"
#include "core/text/plain_text.h"

namespace luxrig {

class Section {
 public:
  /// Reports unknown keys at once.
  Section(const NodeTable& table, const FilePosition& in_file, std::string_view section, ProblemList& problems);

  [[nodiscard]] bool has(std::string_view key) const { return find(table_, key) != nullptr; }
  /// Of the value, or of the table if the key is absent.
  [[nodiscard]] FilePosition place_of(std::string_view key) const;
  [[nodiscard]] const FilePosition& in_file() const { return place_; }
  [[nodiscard]] const NodeTable& table() const { return table_; }
  [[nodiscard]] ProblemList& problems() { return problems_; }

  /// True if the key is there and good; `out` changes only then. Reports an absent required key.
  bool read(std::string_view key, double& out);
  bool read(std::string_view key, int& out);
  bool read(std::string_view key, bool& out);
  bool read(std::string_view key, std::string& out);
  bool read(std::string_view key, Vec3& out);  ///< vector3 or colour
  bool read(std::string_view key, std::pair<double, double>& out);
  bool read(std::string_view key, Eigen::Vector2d& out);  ///< chromaticity: x + y ≤ 1
  bool read(std::string_view key,
            Eigen::AlignedBox3d& out);  ///< corners in any order; a box without volume is reported
  bool read(std::string_view key, std::vector<int>& out);
  template <class T>
  bool read(std::string_view key, std::optional<T>& out) {
    T value{};
    if (!read(key, value)) return false;
    out = std::move(value);
    return true;
  }

  /// For a key with choices: the position of its value among them becomes the enumerator.
  template <class Enum>
  bool read_choice(std::string_view key, Enum& out) {
    const int index = choice(key);
    if (index >= 0) out = static_cast<Enum>(index);
    return index >= 0;
  }
  bool read_deg(std::string_view key, double& out_rad);
  /// The value of a key that has a default; the default if it is absent or wrong.
  [[nodiscard]] double number(std::string_view key);
  [[nodiscard]] bool yes_no(std::string_view key);
  /// A direction, made unit. Reports zero length.
  bool read_normal(std::string_view key, Vec3& out);
  /// Each text with its place.
  bool read_texts(std::string_view key, std::vector<std::pair<std::string, FilePosition>>& out);

  /// Reports a key that has no effect here: "beam_angle_deg has no effect: only with model = "spot"".
  void refuse(std::string_view key, std::string why, std::string mend);
  /// Reports a missing key that this table needs for a reason beyond the schema.
  void require(std::string_view key, std::string_view why);

 private:
  const KeySpec& spec(std::string_view key) const;
  const Node* value(const KeySpec& spec);
  bool number_from(const KeySpec& spec, const Node& node, double& out);
  bool text_from(const KeySpec& spec, const Node& node, std::string& out);
  /// A list of two; otherwise null and a problem.
  const NodeList* pair_from(const KeySpec& spec, const Node& node, std::string_view parts);
  bool three_numbers_from(const KeySpec& spec, const Node& node, Vec3& out);
  int choice(std::string_view key);

  const NodeTable& table_;
  FilePosition place_;
  const SectionSpec& section_;
  std::span<const KeySpec> keys_;
  ProblemList& problems_;
};

/// Calls body for every entry of a list section, or for the one of a plain section, in file order. A section of the
/// wrong shape or with too many entries is reported and skipped.
/// table   the document; for a section "a.b", the table of "a"
void each_section(const NodeTable& table, std::string_view section, ProblemList& problems,
                  const std::function<void(Section&)>& body);

/// Reports the document's sections that this kind of file does not have.
/// what   the file in words, as in "unknown section "buss" in a scenario"; empty for the rig file
void report_unknown_sections(const NodeTable& root, SectionSpec::File file, std::string_view what,
                             ProblemList& problems);

}  // namespace luxrig
