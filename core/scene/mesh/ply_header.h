#pragma once
/// The header of a PLY file (Turk 1994, "The PLY Polygon File Format"): the layout of its bytes, checked before any is
/// read.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace luxrig {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
[[nodiscard]] std::size_t size_bytes(PlyType type);
[[nodiscard]] bool is_integer(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;     ///< of the value, or of each value of a list
  std::optional<PlyType> length_type;  ///< of the count before a list; none = a single value
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;  ///< never empty if count > 0
  int line = 0;
};

enum class PlyFormat { ascii, little_endian, big_endian };

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;  ///< in the order of the body; one `vertex`, one `face`
  std::size_t bytes = 0;             ///< start of the body
  int lines = 0;                     ///< lines of the header
};

inline constexpr std::size_t kMaxPlyHeaderBytes = std::size_t{1} << 16;
inline constexpr std::uint64_t kMaxPlyFaces = 50'000'000;
inline constexpr std::uint64_t kMaxPlyVertices = 3 * kMaxPlyFaces;

/// Whether this property of a face is the list of its corners.
[[nodiscard]] bool names_corners(const PlyProperty& property);

/// `start` holds the file's first kMaxPlyHeaderBytes (all of a shorter file). `file_bytes` is its whole size. `file`
/// names it in problems. A returned header promises no more than the file can hold. It has `vertex` with single x, y
/// and z, and `face` with one list of integers for corners.
[[nodiscard]] Checked<PlyHeader> parse_ply_header(std::string_view start, std::uintmax_t file_bytes,
                                                  const std::string& file);

}  // namespace luxrig
