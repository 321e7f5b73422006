#include "core/scene/mesh/ply_header.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "core/text/plain_text.h"

namespace luxrig {
namespace {

struct NamedType {
  std::string_view name;
  PlyType type;
};
/// The names of 1994, and the later ones with sizes.
constexpr std::array<NamedType, 16> kTypes = {{{"char", PlyType::int8},
                                               {"uchar", PlyType::uint8},
                                               {"short", PlyType::int16},
                                               {"ushort", PlyType::uint16},
                                               {"int", PlyType::int32},
                                               {"uint", PlyType::uint32},
                                               {"float", PlyType::float32},
                                               {"double", PlyType::float64},
                                               {"int8", PlyType::int8},
                                               {"uint8", PlyType::uint8},
                                               {"int16", PlyType::int16},
                                               {"uint16", PlyType::uint16},
                                               {"int32", PlyType::int32},
                                               {"uint32", PlyType::uint32},
                                               {"float32", PlyType::float32},
                                               {"float64", PlyType::float64}}};

std::optional<PlyType> type_named(std::string_view name) {
  const auto* const found =
      std::find_if(kTypes.begin(), kTypes.end(), [&](const NamedType& one) { return one.name == name; });
  return found == kTypes.end() ? std::nullopt : std::optional(found->type);
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; (at = line.find_first_not_of(" \t", at)) != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

class HeaderParser {
 public:
  HeaderParser(std::string_view start, std::uintmax_t file_bytes, const std::string& file)
      : rest_(start), file_bytes_(file_bytes), file_(file) {}

  Checked<PlyHeader> parse() {
    const std::size_t whole = rest_.size();
    bool ended = false;
    while (!ended && problems_.empty()) {
      const auto line = next_line();
      if (!line) {
        problem(0, "has no PLY header that ends within 64 KiB", "give a whole PLY file");
        break;
      }
      if (header_.lines == 1) {
        if (words_of(*line) != std::vector<std::string_view>{"ply"})
          problem(1, "does not begin with the line 'ply'", "give a PLY file");
        continue;
      }
      const auto words = words_of(*line);
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header" && words.size() == 1) {
        ended = true;
      } else if (words[0] == "format") {
        read_format(words, *line);
      } else if (words[0] == "element") {
        read_element(words, *line);
      } else if (words[0] == "property") {
        read_property(words, *line);
      } else {
        problem(header_.lines, "has a header line that PLY does not know: " + in_quotes(*line), "export it again");
      }
    }
    header_.bytes = whole - rest_.size();
    if (problems_.empty()) check_format_and_shape();
    if (problems_.empty()) check_sizes();
    if (!problems_.empty()) return tl::unexpected(std::move(problems_));
    return std::move(header_);
  }

 private:
  void problem(int line, std::string what, std::string mend) {
    problems_.push_back({file_, line, 0, std::move(what), std::move(mend)});
  }

  std::optional<std::string_view> next_line() {
    const std::size_t end = rest_.find('\n');
    if (end == std::string_view::npos) return std::nullopt;
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    ++header_.lines;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  }

  void read_format(const std::vector<std::string_view>& words, std::string_view line) {
    constexpr std::array<std::pair<std::string_view, PlyFormat>, 3> kFormats = {
        {{"ascii", PlyFormat::ascii},
         {"binary_little_endian", PlyFormat::little_endian},
         {"binary_big_endian", PlyFormat::big_endian}}};
    const auto* const found = std::find_if(kFormats.begin(), kFormats.end(), [&](const auto& one) {
      return words.size() == 3 && one.first == words[1] && words[2] == "1.0";
    });
    if (found == kFormats.end()) {
      problem(header_.lines, "has a PLY format that is not known: " + in_quotes(line),
              "export it as 'ascii 1.0' or 'binary_little_endian 1.0'");
    } else if (has_format_ || !header_.elements.empty()) {
      problem(header_.lines, "states its PLY format twice or late", "export it again");
    } else {
      header_.format = found->second;
      has_format_ = true;
    }
  }

  void read_element(const std::vector<std::string_view>& words, std::string_view line) {
    PlyElement element;
    element.line = header_.lines;
    bool good = words.size() == 3;
    if (good) {
      const char* const end = words[2].data() + words[2].size();
      const auto [stop, error] = std::from_chars(words[2].data(), end, element.count);
      good = error == std::errc() && stop == end;
      element.name = words[1];
    }
    if (!good) {
      return problem(header_.lines, "has a PLY element without a name and a count: " + in_quotes(line),
                     "export it again");
    }
    for (const PlyElement& other : header_.elements) {
      if (other.name != element.name) continue;
      return problem(header_.lines, "has the PLY element " + in_quotes(element.name) + " twice", "export it again");
    }
    header_.elements.push_back(std::move(element));
  }

  void read_property(const std::vector<std::string_view>& words, std::string_view line) {
    const bool list = words.size() > 1 && words[1] == "list";
    if (words.size() != (list ? 5u : 3u)) {
      return problem(header_.lines, "has a PLY property without a type and a name: " + in_quotes(line),
                     "export it again");
    }
    const auto length_type = list ? type_named(words[2]) : std::nullopt;
    const auto type = type_named(words[words.size() - 2]);
    if (!type || (list && (!length_type || !is_integer(*length_type)))) {
      return problem(header_.lines, "has a PLY property of a type that is not known: " + in_quotes(line),
                     "export it again");
    }
    if (header_.elements.empty()) {
      return problem(header_.lines, "has a PLY property before any element", "export it again");
    }
    PlyElement& element = header_.elements.back();
    const std::string name(words.back());
    for (const PlyProperty& other : element.properties) {
      if (other.name != name) continue;
      return problem(header_.lines, "has the PLY property " + in_quotes(name) + " twice in one element",
                     "export it again");
    }
    element.properties.push_back({name, *type, length_type});
  }

  void check_format_and_shape() {
    if (!has_format_) problem(0, "does not say whether its PLY is ascii or binary", "export it again");
    const auto element_named = [&](std::string_view name) {
      const auto found = std::find_if(header_.elements.begin(), header_.elements.end(),
                                      [&](const PlyElement& one) { return one.name == name; });
      return found == header_.elements.end() || found->count == 0 ? nullptr : &*found;
    };
    if (const PlyElement* const vertex = element_named("vertex")) {
      for (const char* const axis : {"x", "y", "z"}) {
        if (std::none_of(vertex->properties.begin(), vertex->properties.end(),
                         [&](const PlyProperty& one) { return one.name == axis && !one.length_type; })) {
          problem(vertex->line, std::string("has vertices without ") + axis, "export it with x, y and z");
        }
      }
      if (vertex->count > kMaxPlyVertices) {
        problem(vertex->line, "has more than 150 million vertices", "give a simplified mesh");
      }
    } else {
      problem(0, "has no vertices", "give a mesh with faces");
    }
    if (const PlyElement* const face = element_named("face")) {
      if (std::count_if(face->properties.begin(), face->properties.end(), names_corners) != 1) {
        problem(face->line, "has faces without one list of integers vertex_indices (or vertex_index)",
                "export it again");
      }
      if (face->count > kMaxPlyFaces) {
        problem(face->line, "has more than 50 million faces", "give a simplified mesh");
      }
    } else {
      problem(0, "has no faces", "give a mesh with faces, not a cloud of points");
    }
  }

  /// The minimum that each element needs: in binary its values and list lengths, in ascii a digit and a space for each.
  void check_sizes() {
    std::uintmax_t left = file_bytes_ - std::min<std::uintmax_t>(file_bytes_, header_.bytes);
    if (header_.format == PlyFormat::ascii) ++left;  // the last space may be missing
    for (const PlyElement& element : header_.elements) {
      std::uintmax_t least = 0;
      for (const PlyProperty& property : element.properties) {
        const bool ascii = header_.format == PlyFormat::ascii;
        least += ascii ? 2 : size_bytes(property.length_type.value_or(property.type));
      }
      if (element.count == 0) continue;
      if (least == 0) {
        return problem(element.line, "has a PLY element without properties", "export it again");
      }
      if (element.count > left / least) {
        return problem(element.line, "is cut short: its header promises more elements than it has bytes",
                       "give the whole file");
      }
      left -= element.count * least;
    }
  }

  std::string_view rest_;
  std::uintmax_t file_bytes_;
  const std::string& file_;
  bool has_format_ = false;
  PlyHeader header_;
  std::vector<Problem> problems_;
};

}  // namespace

std::size_t size_bytes(PlyType type) {
  constexpr std::array<std::size_t, 8> kSizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

bool is_integer(PlyType type) { return type != PlyType::float32 && type != PlyType::float64; }

bool names_corners(const PlyProperty& property) {
  return property.length_type && is_integer(property.type) &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

Checked<PlyHeader> parse_ply_header(std::string_view start, std::uintmax_t file_bytes, const std::string& file) {
  return HeaderParser(start.substr(0, kMaxPlyHeaderBytes), file_bytes, file).parse();
}

}  // namespace luxrig
