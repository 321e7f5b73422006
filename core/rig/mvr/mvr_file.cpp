#include "core/rig/mvr/mvr_file.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/rig/personality/xml_file.h"
#include "core/rig/personality/zip_archive.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxMvrFixtures = 10'000, kMaxMvrGeometries = 100'000, kMaxMvrNotes = 100;
constexpr int kDeepestSymbol = 8;
constexpr std::size_t kMaxGdtfBytes = std::size_t{64} << 20, kMaxGdtfBytesInAll = std::size_t{512} << 20;
constexpr double kMetresPerMillimetre = 0.001, kFarthest_m = 9.9e6;  // a rig allows 1e7; lamps are offset

/// A matrix as MVR writes it: the x, y and z axes, then the origin in millimetres.
std::optional<Eigen::Affine3d> affine_of(const pugi::xml_node& node) {
  const std::string_view text = without_blanks(node.child_value("Matrix"));
  if (text.empty()) return Eigen::Affine3d::Identity();
  const std::vector<double> m = numbers_in_braces(text);
  if (m.size() != 12) return std::nullopt;
  Eigen::Affine3d affine = Eigen::Affine3d::Identity();
  for (Eigen::Index column = 0; column < 3; ++column)
    for (Eigen::Index row = 0; row < 3; ++row)
      affine.linear()(row, column) = m[static_cast<std::size_t>(3 * column + row)];
  affine.translation() = kMetresPerMillimetre * Vec3(m[9], m[10], m[11]);
  return affine;
}

/// The rotation nearest to a matrix that may also scale or mirror.
Mat3 rotation_nearest_to(const Mat3& m) {
  const Eigen::JacobiSVD<Mat3> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
  return u * svd.matrixV().transpose();
}

std::optional<MvrAddress> address_of(const pugi::xml_node& node) {
  const std::string_view text = without_blanks(node.child_value());
  MvrAddress out;
  out.dmx_break = static_cast<int>(std::clamp(number_attribute(node, "break", 0), 0.0, 511.0));
  const auto dot = text.find('.');
  const auto whole = [](std::string_view part, double most) -> std::optional<int> {
    const auto number = finite_number(part);
    if (!number || *number != std::floor(*number) || *number < 1 || *number > most) return std::nullopt;
    return static_cast<int>(*number);
  };
  if (dot != std::string_view::npos) {  // universe.address
    const auto universe = whole(text.substr(0, dot), 63999), address = whole(text.substr(dot + 1), 512);
    if (!universe || !address) return std::nullopt;
    out.universe = *universe;
    out.address = *address;
    return out;
  }
  const auto absolute = whole(text, 63999.0 * 512);  // 0 = not patched
  if (!absolute) return std::nullopt;
  out.universe = (*absolute - 1) / 512 + 1;
  out.address = (*absolute - 1) % 512 + 1;
  return out;
}

class MvrReader {
 public:
  MvrReader(const XmlFile& xml, ProblemList& problems) : xml_(xml), problems_(problems) {}

  MvrScene read(const pugi::xml_node& scene) {
    for (const pugi::xml_node& layer : scene.child("Layers").children("Layer")) find_focus_points(layer, {});
    for (const pugi::xml_node& definition : scene.child("AUXData").children("Symdef"))
      symbols_.try_emplace(definition.attribute("uuid").value(), definition);
    for (const pugi::xml_node& layer : scene.child("Layers").children("Layer")) read_below(layer, {});
    if (shapeless_ > 0) {
      note(
          fmt::format("{} objects that are no fixtures (trusses, hoists, screens …) have no model in the file, or "
                      "only one within a GDTF file: they are left out",
                      shapeless_));
    }
    return std::move(out_);
  }

 private:
  void note(std::string text) {
    if (out_.notes.size() < kMaxMvrNotes) out_.notes.push_back(std::move(text));
  }

  /// In the world; nullopt and a problem if its matrix is wrong.
  std::optional<Eigen::Affine3d> placed(const pugi::xml_node& node, const Eigen::Affine3d& parent) {
    const auto own = affine_of(node);
    if (own) {
      const Eigen::Affine3d world = parent * *own;
      if (world.matrix().allFinite() && world.translation().cwiseAbs().maxCoeff() <= kFarthest_m) return world;
    }
    problems_.add(xml_.place_of(node),
                  fmt::format("the Matrix of {} is no four times three numbers within 9900 km",
                              in_quotes(node.attribute("name").value())),
                  "export the file again from the program that made it");
    return std::nullopt;
  }

  struct Placed {
    Eigen::Affine3d pose = Eigen::Affine3d::Identity();
  };

  void find_focus_points(const pugi::xml_node& parent, const Placed& above) {
    const auto pose = affine_of(parent);
    const Placed here{pose ? Eigen::Affine3d(above.pose * *pose) : above.pose};
    for (const pugi::xml_node& node : parent.child("ChildList").children()) {
      if (std::string_view(node.name()) == "FocusPoint") {
        if (const auto own = affine_of(node)) {
          const Vec3 at = (here.pose * *own).translation();
          if (at.allFinite()) focus_[node.attribute("uuid").value()] = at;
        }
      }
      find_focus_points(node, here);
    }
  }

  void read_below(const pugi::xml_node& parent, const Placed& above) {
    const auto pose = placed(parent, above.pose);
    if (!pose) return;
    for (const pugi::xml_node& node : parent.child("ChildList").children()) {
      if (problems_.full()) return;
      const std::string_view kind = node.name();
      if (kind == "Fixture") {
        if (out_.fixtures.size() == kMaxMvrFixtures) {
          problems_.add(xml_.place_of(node), fmt::format("more than {} fixtures", kMaxMvrFixtures),
                        "split the file: a rig has at most so many");
          return;
        }
        read_fixture(node, *pose);
      } else if (kind != "GroupObject" && kind != "FocusPoint") {
        read_object(node, *pose);
      }
      read_below(node, {*pose});
    }
  }

  void read_object(const pugi::xml_node& node, const Eigen::Affine3d& parent) {
    const auto pose = placed(node, parent);
    if (!pose) return;
    const std::size_t before = out_.geometries.size();
    read_models(node.child("Geometries"), *pose, plain_attribute(node, "name"), 0);
    if (out_.geometries.size() == before) ++shapeless_;
  }

  /// Models and symbols. A symbol is a model defined once for many places. Matrices multiply.
  void read_models(const pugi::xml_node& list, const Eigen::Affine3d& parent, const std::string& object, int depth) {
    for (const pugi::xml_node& node : list.children()) {
      if (problems_.full()) return;
      const bool model = std::string_view(node.name()) == "Geometry3D";
      if (!model && std::string_view(node.name()) != "Symbol") continue;
      if (++models_looked_at_ > kMaxMvrGeometries || depth > kDeepestSymbol) {
        if (!std::exchange(too_many_models_, true))
          note(fmt::format("more than {} models, or symbols within symbols more than {} deep: the rest is left out",
                           kMaxMvrGeometries, kDeepestSymbol));
        return;
      }
      const auto pose = placed(node, parent);
      if (!pose) continue;
      if (model) {
        const std::string file(without_blanks(node.attribute("fileName").value()));
        if (!file.empty()) out_.geometries.push_back({object, file, *pose});
        continue;
      }
      const auto symbol = symbols_.find(node.attribute("symdef").value());
      if (symbol == symbols_.end()) {
        note(fmt::format("{} shows a symbol that is not in the file", in_quotes(object)));
        continue;
      }
      for (const char* const where : {"ChildList", "Geometries"})  // the standard has the former; files have either
        read_models(symbol->second.child(where), *pose, object, depth + 1);
    }
  }

  void read_fixture(const pugi::xml_node& node, const Eigen::Affine3d& parent) {
    const auto pose = placed(node, parent);
    if (!pose) return;
    const auto text = [&](const char* child) { return made_plain(without_blanks(node.child_value(child))); };
    MvrFixture fixture;
    fixture.name = plain_attribute(node, "name");
    fixture.gdtf_file = text("GDTFSpec");
    fixture.gdtf_mode = text("GDTFMode");
    fixture.line = xml_.place_of(node).line;
    fixture.world_from_base.rotation = rotation_nearest_to(pose->linear());
    fixture.world_from_base.translation_m = pose->translation();
    if (pose->linear().determinant() < 0)
      note(fmt::format("line {}: {} is mirrored; the mirror was left out", fixture.line, in_quotes(fixture.name)));
    const auto focus = focus_.find(std::string(without_blanks(node.child_value("Focus"))));
    if (focus != focus_.end()) fixture.focus_world_m = focus->second;
    fixture.inverts_pan = text("DMXInvertPan") == "true";
    fixture.inverts_tilt = text("DMXInvertTilt") == "true";
    for (const pugi::xml_node& address : node.child("Addresses").children("Address"))
      if (const auto patched = address_of(address)) fixture.addresses.push_back(*patched);
    out_.fixtures.push_back(std::move(fixture));
  }

  const XmlFile& xml_;
  ProblemList& problems_;
  std::map<std::string, Vec3> focus_;
  std::map<std::string, pugi::xml_node> symbols_;
  std::size_t shapeless_ = 0, models_looked_at_ = 0;  // the latter with symbols, which may contain each other
  bool too_many_models_ = false;
  MvrScene out_;
};

}  // namespace

Checked<MvrScene> parse_mvr_scene(std::string_view text, const std::string& file) {
  const Checked<XmlFile> xml = XmlFile::parse(text, file);
  if (!xml) return tl::unexpected(xml.error());
  ProblemList problems(file);
  const pugi::xml_node root = xml->root(), scene = root.child("Scene");
  if (std::string_view(root.name()) != "GeneralSceneDescription" || !scene) {
    problems.add(xml->place_of(root), "no <GeneralSceneDescription> with a <Scene>", "name an .mvr file");
    return tl::unexpected(problems.take());
  }
  if (const double major = number_attribute(root, "verMajor", 1); major != 1) {
    problems.add(xml->place_of(root), fmt::format("MVR version {:g} is not known", major), "export it as MVR 1.6");
    return tl::unexpected(problems.take());
  }
  MvrScene out = MvrReader(*xml, problems).read(scene);
  if (!problems.empty()) return tl::unexpected(problems.take());
  return out;
}

Checked<MvrFile> read_mvr(std::string bytes, const std::string& file) {
  const Checked<ZipArchive> archive = ZipArchive::open(std::move(bytes), file);
  if (!archive) return tl::unexpected(archive.error());
  const std::string* description = archive->find("GeneralSceneDescription.xml");
  if (description == nullptr) {
    return tl::unexpected(std::vector<Problem>{
        {file, 0, 0, "no GeneralSceneDescription.xml in the archive", "an MVR file has one at its root"}});
  }
  const Checked<std::string> xml = archive->read(*description, kMaxXmlBytes);
  if (!xml) return tl::unexpected(xml.error());
  Checked<MvrScene> scene = parse_mvr_scene(*xml, file + "/" + *description);
  if (!scene) return tl::unexpected(scene.error());
  MvrFile out{std::move(*scene), {}, *archive};
  std::size_t total = 0;
  for (const MvrFixture& fixture : out.scene.fixtures) {
    if (fixture.gdtf_file.empty() || out.gdtf_files.contains(fixture.gdtf_file)) continue;
    const std::string* entry = archive->find(fixture.gdtf_file, ".gdtf");
    if (entry == nullptr || total > kMaxGdtfBytesInAll) continue;
    Checked<std::string> content = archive->read(*entry, kMaxGdtfBytes);
    if (!content) return tl::unexpected(content.error());
    total += content->size();
    out.gdtf_files.emplace(fixture.gdtf_file, std::move(*content));
  }
  return out;
}

}  // namespace luxrig
