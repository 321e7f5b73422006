#include "core/scene/mesh/mtl_file.h"

#include <utility>

#include "core/scene/mesh/mesh_text.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxMtlMaterials = 100'000;

/// The file of a map statement. Before it come options, each with its own number of arguments.
std::string file_of_map(TextLine& line) {
  for (;;) {
    TextLine ahead = line;
    const std::string_view word = ahead.next();
    if (word.size() < 2 || word.front() != '-' || number_of_word(word)) return std::string(line.rest());
    const bool numbers = word == "-s" || word == "-o" || word == "-t";  // one to three
    int arguments = word == "-mm" ? 2 : 1;
    line = ahead;
    if (!numbers) {
      for (; arguments > 0; --arguments) (void)line.next();
      continue;
    }
    for (int i = 0; i < 3; ++i) {
      ahead = line;
      if (!number_of_word(ahead.next())) break;
      line = ahead;
    }
  }
}

class MtlReader {
 public:
  explicit MtlReader(const std::string& file) : problems_(file), file_(file) {}

  Checked<MtlFile> read(std::string_view text) {
    TextLines lines(text);
    while (auto line = lines.next()) {
      const std::string_view key = line->next();
      if (key == "newmtl") {
        if (out_.materials.size() == kMaxMtlMaterials) {
          problems_.add(*line, "has more than 100 000 materials", "export it with fewer");
          break;
        }
        out_.materials.push_back({made_plain(line->rest()), std::nullopt, ""});
        transparent_ = glows_ = false;
      } else if (key == "Kd" || key == "map_Kd" || key == "map_kd") {
        if (out_.materials.empty()) {
          warn(*line, std::string(key) + " before the first newmtl is left out");
        } else if (key == "Kd") {
          read_colour(*line);
        } else {
          out_.materials.back().texture = file_of_map(*line);
        }
      } else if (key == "d" || key == "Tr" || key == "Ke") {
        read_ignored(key, *line);
      }
      if (problems_.full()) break;
    }
    if (!problems_.empty()) return tl::unexpected(problems_.take());
    return std::move(out_);
  }

 private:
  void warn(const TextLine& line, const std::string& text) {
    if (out_.warnings.size() < 20)
      out_.warnings.push_back(file_ + ", line " + std::to_string(line.number()) + ": " + text);
  }

  void read_colour(TextLine& line) {
    std::string_view word = line.next();
    if (word == "spectral" || word == "xyz") return warn(line, "a Kd by " + std::string(word) + " is left out");
    Vec3 colour;
    for (Eigen::Index i = 0; i < 3; ++i, word = line.next()) {
      if (i > 0 && word.empty()) {  // one number stands for all three
        colour[i] = colour[i - 1];
        continue;
      }
      const auto value = number_of_word(word);
      if (!value) return problems_.add_no_number(line, word, "a number of Kd");
      colour[i] = *value;
    }
    if (colour.allFinite()) out_.materials.back().colour = colour;
  }

  /// Transparency and emission: light does not pass through meshes, and comes only from fixtures.
  void read_ignored(std::string_view key, TextLine& line) {
    const auto value = number_of_word(line.next());
    if (!value || out_.materials.empty()) return;
    const std::string name = in_quotes(out_.materials.back().name);
    if (key == "Ke") {
      Vec3 colour(*value, 0, 0);
      colour[1] = number_of_word(line.next()).value_or(*value);
      colour[2] = number_of_word(line.next()).value_or(*value);
      if (colour.maxCoeff() > 0 && !std::exchange(glows_, true))
        warn(line, "material " + name + " gives light (Ke): left out, light comes from [[fixture]] entries");
    } else if ((key == "d" ? *value < 1 : *value > 0) && !std::exchange(transparent_, true)) {
      warn(line, "material " + name + " is transparent (" + std::string(key) +
                     "): taken as opaque; a pane is a [[scene.object]] with transmittance");
    }
  }

  TextProblems problems_;
  std::string file_;
  MtlFile out_;
  bool transparent_ = false, glows_ = false;
};

}  // namespace

Checked<MtlFile> parse_mtl(std::string bytes, const std::string& file) {
  const std::string text = utf8_of(std::move(bytes));
  return MtlReader(file).read(text);
}

}  // namespace luxrig
