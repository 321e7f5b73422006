#pragma once
/// Every key of the rig file, of register maps and of scenarios, once: type, unit, default, range, example and meaning. The reader
/// checks values against this table (section.h). The tables of rigs/REFERENCE.md (tools/reference) and the rig that
/// tests read with every key set are made from it.

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace luxrig {

enum class ValueType {
  text,
  name,  ///< text by which a person refers to an object: 1…100 characters
  file,  ///< path, relative to the folder of the rig file
  number,
  whole_number,
  yes_no,
  vector3,       ///< [x, y, z]
  span2,         ///< [from, to], from < to
  box,           ///< [[x, y, z], [x, y, z]], two opposite corners
  colour,        ///< one number, or [r, g, b]
  chromaticity,  ///< [x, y] of CIE 1931
  texts,         ///< list of text
  whole_numbers  ///< list of them
};

/// Inclusive bounds of a number, or of each number of a list.
struct Bounds {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool above_min = false;  ///< min itself is not allowed
  bool below_max = false;  ///< max itself is not allowed
  [[nodiscard]] bool contain(double x) const {
    return (above_min ? x > min : x >= min) && (below_max ? x < max : x <= max);
  }
};

struct KeySpec {
  std::string_view section;
  std::string_view key;
  ValueType type;
  std::string_view unit;      ///< empty = none
  std::string_view fallback;  ///< as TOML; or kRequired, or kNone (no value if left out)
  Bounds bounds;
  std::string_view choices;  ///< "m, cm, mm": the only texts allowed, in the order of their enumeration
  std::string_view example;  ///< as TOML; not the default, so that a test sees that it is read
  std::string_view summary;
};
inline constexpr std::string_view kRequired = "required";
inline constexpr std::string_view kNone = "none";

struct SectionSpec {
  std::string_view name;     ///< "fixture", "scene.object"
  bool list;                 ///< [[name]], any number of times; if false, [name], at most once
  std::size_t most;          ///< most entries of a list
  bool takes_other_keys;     ///< [[bus]]: the driver's own keys
  /// File that it belongs to.
  enum class File { rig, register_map, scenario } file = File::rig;
};

/// Sections of all files.
[[nodiscard]] std::span<const SectionSpec> sections();
[[nodiscard]] const SectionSpec& section_spec(std::string_view section);

/// All keys. Those of one section are adjacent, in the order of the reference.
[[nodiscard]] std::span<const KeySpec> keys();
[[nodiscard]] std::span<const KeySpec> keys_of(std::string_view section);

/// "[[fixture]]", "[limits]".
[[nodiscard]] std::string heading_of(const SectionSpec& section);

[[nodiscard]] std::vector<std::string_view> choices_of(const KeySpec& spec);

/// "0 to 1", "above 0", "m, cm or mm"; empty if anything is allowed.
[[nodiscard]] std::string range_text(const KeySpec& spec);
[[nodiscard]] std::string_view type_text(ValueType type);

}  // namespace luxrig
