#include "core/rig/luminaire_file/tm33_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/photometry/files/file_text.h"
#include "core/photometry/files/ies_angles.h"
#include "core/rig/luminaire_file/choices.h"
#include "core/rig/luminaire_file/xml_child.h"

namespace luxrig {
namespace {

using file_text::At;
using file_text::number_text;
using file_text::ProblemLog;

constexpr std::size_t kMaxTm33Values = 4'000'000;
constexpr std::size_t kMaxTm33Angles = 10'000;
constexpr double kMaxTm33Candela = 1e12;
constexpr double kMinTm33Flux_lm = 1e-6;
constexpr double kTm33FluxTolerance = 0.05;
constexpr double kSameTm33Angle_deg = 1e-6;

At at_of(const XmlFile& xml, const pugi::xml_node& node) {
  const FilePosition in_file = xml.place_of(node);
  return {in_file.line, in_file.column};
}

/// Letters and digits only: files have "CIE-C", "CIE _ C" and "Symm _ Quad".
std::string letters_of(std::string_view text) {
  std::string out;
  for (const char c : file_text::lower(text))
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) out += c;
  return out;
}

/// The element that holds an emitter's <IntensityData>; null if it has no distribution.
pugi::xml_node distribution_of(const pugi::xml_node& emitter) {
  return emitter.find_node([](const pugi::xml_node& node) { return local_name(node) == "IntensityData"; }).parent();
}

class Tm33Reader {
 public:
  Tm33Reader(const XmlFile& xml, const pugi::xml_node& emitter)
      : xml_(xml), emitter_(emitter), data_(distribution_of(emitter)), problems_(xml.file()) {}

  Checked<PhotometricFile> read() {
    if (!read_kind() || !read_grid()) return tl::unexpected(problems_.take());
    if (!check_ies_angles(file_, at_of(xml_, data_), at_of(xml_, data_), problems_, file_.warnings))
      return tl::unexpected(problems_.take());
    PhotometricFile out;
    const double largest_cd = *std::max_element(file_.candela.begin(), file_.candela.end());
    if (4 * kPi * largest_cd >= kMinTm33Flux_lm) out.intensity = make_intensity(file_);
    if (!out.intensity || !(out.intensity->flux_lm() >= kMinTm33Flux_lm)) {
      problems_.add(at_of(xml_, data_), "the luminaire gives no light", "give a file with candela values");
      return tl::unexpected(problems_.take());
    }
    out.opening.note = "the size of its light is not read from TM-33 files: taken as a point";
    out.input_w = std::max(0.0, finite_number(text_of_child(emitter_, "InputWattage")).value_or(0));
    note_flux(out.intensity->flux_lm());
    out.warnings = std::move(file_.warnings);
    return out;
  }

 private:
  /// A text about the data: beside the data, else from the emitter.
  std::string said(std::string_view name) const {
    const std::string near = text_of_child(data_, name);
    return near.empty() ? text_of_child(emitter_, name) : near;
  }

  bool read_kind() {
    const std::string metric = letters_of(said("Metric"));
    if (!metric.empty() && metric != "luminous") {
      problems_.add(at_of(xml_, data_), fmt::format("its intensities are \"{}\", not candela", said("Metric")),
                    "give the luminous data of a visible-light luminaire");
      return false;
    }
    const std::string type = letters_of(said("PhotometryType"));
    if (type == "ciea" || type == "a" || type == "typea")
      file_.type = IesFile::Type::a;
    else if (type == "cieb" || type == "b" || type == "typeb")
      file_.type = IesFile::Type::b;
    else if (!type.empty() && type != "ciec" && type != "c" && type != "typec") {
      problems_.add(at_of(xml_, data_),
                    fmt::format("PhotometryType {} is not known", in_quotes(said("PhotometryType"))),
                    "write CIE-C, CIE-B or CIE-A");
      return false;
    }
    return true;
  }

  struct Value {
    double horizontal_deg, vertical_deg, cd;
    pugi::xml_node node;
  };

  bool read_values(std::vector<Value>& values) {
    const std::string multiplier_text = said("Multiplier");
    const std::optional<double> multiplier =
        multiplier_text.empty() ? std::optional(1.0) : finite_number(multiplier_text);
    if (!multiplier || !(*multiplier > 0) || *multiplier > 1e9) {
      problems_.add(at_of(xml_, data_), fmt::format("Multiplier {} is no factor", in_quotes(multiplier_text)),
                    "write a number above 0, usually 1");
      return false;
    }
    const bool round = file_.type == IesFile::Type::c;
    for (const pugi::xml_node& node : children_called(data_, "IntensityData")) {
      const auto angle = [&](const char* name, double least, double most) {
        const std::string_view text = node.attribute(name).value();
        const std::optional<double> deg = finite_number(text);
        if (!deg || *deg < least || *deg > most) {
          problems_.add(at_of(xml_, node), fmt::format("{} {} is no angle", name, in_quotes(text)),
                        fmt::format("write degrees from {:g} to {:g}", least, most));
        }
        return deg.value_or(0);
      };
      const double horizontal_deg = angle("horz", round ? 0 : -90, round ? 360 : 90);
      const double vertical_deg = angle("vert", round ? 0 : -90, round ? 180 : 90);
      const std::optional<double> cd = finite_number(node.child_value());
      if (!cd || *cd < 0 || *cd * *multiplier > kMaxTm33Candela) {
        problems_.add(at_of(xml_, node),
                      fmt::format("intensity {} is not a number of candela", in_quotes(node.child_value())),
                      "write a plain number, 0 or more, with a decimal point");
      }
      if (problems_.full()) return false;
      if (values.size() == kMaxTm33Values) {
        problems_.add(at_of(xml_, node), "more than 4 million intensities", "give a coarser grid");
        return false;
      }
      values.push_back({horizontal_deg, vertical_deg, cd.value_or(0) * *multiplier, node});
    }
    return problems_.empty();
  }

  static std::vector<double> distinct(std::vector<double> angles_deg) {
    std::sort(angles_deg.begin(), angles_deg.end());
    angles_deg.erase(std::unique(angles_deg.begin(), angles_deg.end(),
                                 [](double a, double b) { return b - a < kSameTm33Angle_deg; }),
                     angles_deg.end());
    return angles_deg;
  }

  static std::size_t index_of(const std::vector<double>& angles_deg, double deg) {
    const auto after = std::upper_bound(angles_deg.begin(), angles_deg.end(), deg + kSameTm33Angle_deg / 2);
    return static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, after - angles_deg.begin() - 1));
  }

  bool read_grid() {
    std::vector<Value> values;
    if (!read_values(values)) return false;
    std::vector<double> horizontal_deg, vertical_deg;
    for (const Value& value : values) {
      horizontal_deg.push_back(value.horizontal_deg);
      vertical_deg.push_back(value.vertical_deg);
    }
    file_.horizontal_deg = distinct(std::move(horizontal_deg));
    file_.vertical_deg = distinct(std::move(vertical_deg));
    const std::size_t columns = file_.horizontal_deg.size(), rows = file_.vertical_deg.size();
    if (rows < 2 || columns > kMaxTm33Angles || rows > kMaxTm33Angles || columns * rows > kMaxTm33Values) {
      problems_.add(at_of(xml_, data_),
                    fmt::format("{} horizontal and {} vertical angles make no distribution", columns, rows),
                    "give a full grid of at least two vertical angles and at most 4 million values");
      return false;
    }
    file_.candela.assign(columns * rows, -1);
    for (const Value& value : values) {
      double& cd = file_.candela[index_of(file_.horizontal_deg, value.horizontal_deg) * rows +
                                 index_of(file_.vertical_deg, value.vertical_deg)];
      if (cd >= 0) {
        problems_.add(
            at_of(xml_, value.node),
            fmt::format("a second intensity at horz {:g}, vert {:g}", value.horizontal_deg, value.vertical_deg),
            "keep one of the two");
        return false;
      }
      cd = value.cd;
    }
    const auto hole = std::find(file_.candela.begin(), file_.candela.end(), -1);
    if (hole == file_.candela.end()) return true;
    const auto at = static_cast<std::size_t>(hole - file_.candela.begin());
    problems_.add(at_of(xml_, data_),
                  fmt::format("no intensity at horz {:g}, vert {:g}", file_.horizontal_deg[at / rows],
                              file_.vertical_deg[at % rows]),
                  "give one at every horizontal angle for every vertical angle");
    return false;
  }

  void note_flux(double flux_lm) {
    const std::string stated = text_of_child(emitter_, "RatedLumens");
    const double rated_lm = finite_number(stated).value_or(0);
    if (rated_lm > 0 && std::abs(flux_lm / rated_lm - 1) > kTm33FluxTolerance) {
      file_.warnings.push_back("the distribution holds " + number_text(flux_lm) + " lm, RatedLumens says " +
                               number_text(rated_lm) + " lm");
    }
    const double quantity = finite_number(text_of_child(emitter_, "Quantity")).value_or(1);
    if (quantity > 1) {
      file_.warnings.push_back("the luminaire has " + number_text(quantity) +
                               " of this emitter; its intensities are taken for all of them together");
    }
  }

  const XmlFile& xml_;
  pugi::xml_node emitter_, data_;
  ProblemLog problems_;
  IesFile file_;
};

}  // namespace

Checked<PhotometricFile> parse_tm33(std::string_view text, const std::string& file,
                                    const std::optional<std::string>& emitter) {
  const std::optional<std::string> decoded = file_text::from_utf16(text);
  const Checked<XmlFile> xml = XmlFile::parse(decoded ? std::string_view(*decoded) : text, file);
  if (!xml) return tl::unexpected(xml.error());
  const auto refuse = [&](const pugi::xml_node& node, std::string what, std::string mend) {
    const FilePosition in_file = xml->place_of(node);
    return tl::unexpected(std::vector<Problem>{{file, in_file.line, in_file.column, std::move(what), std::move(mend)}});
  };
  const std::string_view root = local_name(xml->root());
  if (root != "LuminaireOpticalData" && !root.starts_with("IESTM33")) {
    return refuse(xml->root(), fmt::format("root element {} is not that of a TM-33 file", in_quotes(root)),
                  "give an IES TM-33 file, or the whole .gldf file if this is its product.xml");
  }
  std::vector<Choice> choices;
  std::vector<pugi::xml_node> nodes;
  int number = 0;
  for (const pugi::xml_node& node : children_called(xml->root(), "Emitter")) {
    ++number;
    if (!distribution_of(node)) continue;
    std::string name = text_of_child(node, "ID");
    if (name.empty()) name = std::to_string(number);
    choices.push_back({std::move(name), text_of_child(node, "Description")});
    nodes.push_back(node);
  }
  if (choices.empty()) {
    return refuse(xml->root(), "no emitter with <IntensityData>", "export the file with its intensity distribution");
  }
  const auto chosen = choose(choices, emitter, "emitter", "file_emitter");
  if (!chosen) return refuse(xml->root(), chosen.error().what, chosen.error().mend);
  return Tm33Reader(*xml, nodes[*chosen]).read();
}

}  // namespace luxrig
