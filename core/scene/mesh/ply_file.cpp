#include "core/scene/mesh/ply_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "core/scene/mesh/ply_header.h"

namespace luxrig {
namespace {

/// The bytes of a body, read in blocks.
class Bytes {
 public:
  Bytes(std::ifstream& in) : in_(in), block_(std::size_t{1} << 16) {}

  /// The next byte, or -1 at the end.
  int next() {
    if (at_ == end_ && !refill()) return -1;
    return static_cast<unsigned char>(block_[at_++]);
  }
  bool read(char* to, std::size_t count) {
    for (; count > 0;) {
      if (at_ == end_ && !refill()) return false;
      const std::size_t some = std::min(count, end_ - at_);
      if (to != nullptr) {  // null = skip
        std::memcpy(to, &block_[at_], some);
        to += some;
      }
      at_ += some;
      count -= some;
    }
    return true;
  }

 private:
  bool refill() {
    in_.read(block_.data(), static_cast<std::streamsize>(block_.size()));
    at_ = 0;
    end_ = static_cast<std::size_t>(std::max<std::streamsize>(in_.gcount(), 0));
    return end_ > 0;
  }

  std::ifstream& in_;
  std::vector<char> block_;
  std::size_t at_ = 0, end_ = 0;
};

/// Values in sequence, in any format. Each read returns nullopt at the end or if there is no number.
class Values {
 public:
  Values(std::ifstream& in, const PlyHeader& header) : bytes_(in), format_(header.format), line_(header.lines + 1) {}

  /// A double holds every value of every type.
  std::optional<double> next(PlyType type) { return format_ == PlyFormat::ascii ? from_text(type) : from_binary(type); }

  bool skip(PlyType type, std::uint64_t count) {
    if (format_ != PlyFormat::ascii) {
      for (; count > 0;) {  // in parts, so that the product cannot overflow
        const std::uint64_t part = std::min<std::uint64_t>(count, 1u << 20);
        if (!bytes_.read(nullptr, part * size_bytes(type))) return false;
        count -= part;
      }
      return true;
    }
    for (; count > 0; --count) {
      if (!next_word()) return false;
    }
    return true;
  }

  /// Line of the last value; 0 in a binary body.
  [[nodiscard]] int line() const { return format_ == PlyFormat::ascii ? word_line_ : 0; }
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  template <class T>
  std::optional<double> value_as() {
    std::array<char, sizeof(T)> bytes{};
    if (!bytes_.read(bytes.data(), bytes.size())) {
      ended_ = true;
      return std::nullopt;
    }
    if (format_ == PlyFormat::big_endian) std::reverse(bytes.begin(), bytes.end());
    T value;
    std::memcpy(&value, bytes.data(), bytes.size());
    return static_cast<double>(value);
  }

  std::optional<double> from_binary(PlyType type) {
    switch (type) {
      case PlyType::int8:
        return value_as<std::int8_t>();
      case PlyType::uint8:
        return value_as<std::uint8_t>();
      case PlyType::int16:
        return value_as<std::int16_t>();
      case PlyType::uint16:
        return value_as<std::uint16_t>();
      case PlyType::int32:
        return value_as<std::int32_t>();
      case PlyType::uint32:
        return value_as<std::uint32_t>();
      case PlyType::float32:
        return value_as<float>();
      case PlyType::float64:
        return value_as<double>();
    }
    return std::nullopt;
  }

  /// One word of at most 63 characters, delimited by white space.
  std::optional<std::string_view> next_word() {
    int c = bytes_.next();
    while (c == ' ' || c == '\t' || c == '\r' || c == '\n') {
      line_ += c == '\n' ? 1 : 0;
      c = bytes_.next();
    }
    word_line_ = line_;
    std::size_t length = 0;
    for (; c >= 0 && c != ' ' && c != '\t' && c != '\r' && c != '\n'; c = bytes_.next()) {
      if (length == word_.size()) return std::nullopt;
      word_[length++] = static_cast<char>(c);
    }
    line_ += c == '\n' ? 1 : 0;
    ended_ = length == 0;
    if (length == 0) return std::nullopt;
    return std::string_view(word_.data(), length);
  }

  std::optional<double> from_text(PlyType type) {
    auto word = next_word();
    if (!word) return std::nullopt;
    if (word->front() == '+') word->remove_prefix(1);
    double value = 0;
    const char* const end = word->data() + word->size();
    const auto [stop, error] = std::from_chars(word->data(), end, value);
    if (stop != end || error == std::errc::invalid_argument) return std::nullopt;
    if (error != std::errc()) value = std::numeric_limits<double>::quiet_NaN();  // beyond double: not a position
    if (is_integer(type) && (!std::isfinite(value) || value != std::trunc(value))) return std::nullopt;
    return value;
  }

  Bytes bytes_;
  PlyFormat format_;
  std::array<char, 63> word_{};
  int line_;
  int word_line_ = 0;
  bool ended_ = false;
};

double to_coordinate(double value) {
  constexpr double kMax = std::numeric_limits<float>::max();
  return std::abs(value) <= kMax ? value : std::numeric_limits<double>::quiet_NaN();
}

/// The value of full white, by type.
double full_colour(PlyType type) {
  return type == PlyType::uint8 ? 255 : type == PlyType::uint16 ? 65535 : is_integer(type) ? 0 : 1;
}

/// 0, 1, 2 for red, green, blue; else -1.
int colour_of(std::string_view property) {
  if (property.starts_with("diffuse_")) property.remove_prefix(8);
  return property == "red" ? 0 : property == "green" ? 1 : property == "blue" ? 2 : -1;
}

std::uint32_t to_index(double value) {
  constexpr double kMax = std::numeric_limits<std::uint32_t>::max();
  return value >= 0 && value <= kMax ? static_cast<std::uint32_t>(value) : std::numeric_limits<std::uint32_t>::max();
}

class BodyReader {
 public:
  BodyReader(std::ifstream& in, const PlyHeader& header, std::string file)
      : header_(header), values_(in, header), file_(std::move(file)) {}

  Checked<PolygonMesh> read() {
    for (const PlyElement& element : header_.elements) {
      const bool is_vertex = element.name == "vertex";
      const bool is_face = element.name == "face";
      if (is_vertex) mesh_.vertices.reserve(element.count);  // the header is checked: no more than the file can hold
      if (is_face) mesh_.corner_counts.reserve(element.count);
      coloured_ = is_vertex && std::any_of(element.properties.begin(), element.properties.end(), [](const auto& p) {
                    return !p.length_type && full_colour(p.type) > 0 && colour_of(p.name) >= 0;
                  });
      for (std::uint64_t i = 0; i < element.count; ++i) {
        if (is_vertex) add_vertex();
        for (const PlyProperty& property : element.properties) {
          if (!read_property(property, is_vertex, is_face)) return refuse(element.name, i);
        }
      }
    }
    return std::move(mesh_);
  }

 private:
  void add_vertex() {
    mesh_.vertices.emplace_back(Vec3::Zero());
    if (coloured_) mesh_.colours.emplace_back(Vec3f::Ones());
  }

  bool read_property(const PlyProperty& property, bool is_vertex, bool is_face) {
    if (!property.length_type) {
      const int axis = !is_vertex || property.name.size() != 1 ? -1 : property.name[0] - 'x';
      const int colour = is_vertex && full_colour(property.type) > 0 ? colour_of(property.name) : -1;
      if ((axis < 0 || axis > 2) && colour < 0) return values_.skip(property.type, 1);
      const auto value = values_.next(property.type);
      if (!value) return false;
      if (colour < 0) {
        mesh_.vertices.back()[axis] = to_coordinate(*value);
      } else if (std::isfinite(*value)) {
        const double part = std::clamp(*value / full_colour(property.type), 0.0, 1.0);
        mesh_.colours.back()[colour] = static_cast<float>(linear_of_srgb(part));
      }
      return true;
    }
    const auto length = values_.next(*property.length_type);
    if (!length || *length < 0 || *length > std::numeric_limits<std::uint32_t>::max()) return false;
    const auto count = static_cast<std::uint64_t>(*length);
    if (!is_face || !names_corners(property)) return values_.skip(property.type, count);
    too_many_corners_ = count > kMaxCorners;
    if (too_many_corners_) return false;
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto index = values_.next(property.type);
      if (!index) return false;
      mesh_.corners.push_back(to_index(*index));
    }
    mesh_.corner_counts.push_back(static_cast<std::uint32_t>(count));
    return true;
  }

  [[nodiscard]] tl::unexpected<std::vector<Problem>> refuse(const std::string& element, std::uint64_t index) const {
    const std::string at =
        (element == "vertex" || element == "face" ? element : std::string("element")) + " " + std::to_string(index + 1);
    Problem problem{file_, values_.line(), 0, "", ""};
    if (too_many_corners_) {
      problem.what = "has more than " + std::to_string(kMaxCorners) + " corners in " + at;
      problem.mend = "export it as triangles";
    } else if (values_.ended() || values_.line() == 0) {
      problem.what = "is cut short at " + at;
      problem.mend = "give the whole file";
    } else {
      problem.what = "has no number of the stated type in " + at;
      problem.mend = "export it again";
    }
    return tl::unexpected(std::vector<Problem>{std::move(problem)});
  }

  const PlyHeader& header_;
  Values values_;
  std::string file_;
  PolygonMesh mesh_;
  bool too_many_corners_ = false, coloured_ = false;
};

}  // namespace

Checked<PolygonMesh> read_ply(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::error_code error;
  const auto file_bytes = std::filesystem::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  if (error || !in) {
    return tl::unexpected(std::vector<Problem>{
        {file, 0, 0, "cannot be read", "correct its name, relative to the rig file, or its rights"}});
  }
  std::string start(std::min<std::uintmax_t>(file_bytes, kMaxPlyHeaderBytes), '\0');
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(in.gcount()));
  const auto header = parse_ply_header(start, file_bytes, file);
  if (!header) return tl::unexpected(header.error());
  in.clear();
  in.seekg(static_cast<std::streamoff>(header->bytes));
  return BodyReader(in, *header, file).read();
}

}  // namespace luxrig
