#include "core/rig/personality/gdtf/gdtf_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/text/nearest.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxInstances = 4096;
constexpr double kLargestPart_m = 100;  // 100 nested levels of it stay within the size of a rig
constexpr double kStraight = 0.01;      // largest sine between parallel axes, since drawings are inexact

bool is_geometry(const pugi::xml_node& node) {
  // Other children (Break, pins of a connector, …) are not parts of the fixture that channels could act on.
  static const std::set<std::string_view> kOthers = {"Break", "PinPatch", "Protocol", "MagnetGroup", "LaserLine"};
  return node.type() == pugi::node_element && !kOthers.contains(node.name());
}

BeamGeometry beam_of(const pugi::xml_node& node) {
  const auto at_least_0 = [&](const char* name) { return std::max(0.0, number_attribute(node, name, 0)); };
  return {at_least_0("LuminousFlux"), at_least_0("BeamAngle"), at_least_0("FieldAngle"), at_least_0("ColorTemperature"),
          at_least_0("PowerConsumption")};
}

Pose pose_of(const pugi::xml_node& node) {
  const std::vector<double> m = numbers_in_braces(node.attribute("Position").value());
  Pose pose;
  if (m.size() != 16) return pose;
  Mat3 rotation;
  rotation << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
  for (int c = 0; c < 3; ++c) {
    const double length = rotation.col(c).norm();
    if (!(length > 1e-9) || !std::isfinite(length)) return pose;
    rotation.col(c) /= length;
  }
  pose.rotation = rotation;
  const Vec3 translation_m(m[3], m[7], m[11]);
  if (translation_m.norm() <= kLargestPart_m) pose.translation_m = translation_m;
  return pose;
}

/// State of the tree walk that applies below a reference.
struct ReferenceOffsets {
  std::map<int, int> added_by_break;
  std::optional<std::pair<int, int>> overwrite;
};

ReferenceOffsets offsets_of(const pugi::xml_node& reference, const ReferenceOffsets& outer) {
  ReferenceOffsets own = outer;
  for (const pugi::xml_node& node : reference.children("Break")) {
    const int number = static_cast<int>(std::clamp(number_attribute(node, "DMXBreak", 1), 1.0, 512.0));
    const int added = static_cast<int>(std::clamp(number_attribute(node, "DMXOffset", 1), 1.0, 512.0)) - 1;
    const auto outer_added = outer.added_by_break.find(number);
    own.added_by_break[number] = added + (outer_added == outer.added_by_break.end() ? 0 : outer_added->second);
    own.overwrite = {number, own.added_by_break[number]};  // the last one applies
  }
  return own;
}

class GeometryWalk {
 public:
  GeometryWalk(const XmlFile& xml, const pugi::xml_node& geometries, ProblemList& problems)
      : xml_(xml), geometries_(geometries), problems_(problems) {}

  void walk(const pugi::xml_node& node, std::optional<std::size_t> parent, const ReferenceOffsets& offsets) {
    if (full()) return;
    const bool reference = std::string_view(node.name()) == "GeometryReference";
    const std::string name = plain_attribute(node, "Name");
    GdtfInstance own{{name, parent, std::nullopt}, name, pose_of(node), offsets.added_by_break, offsets.overwrite};
    if (std::string_view(node.name()) == "Beam") own.geometry.beam = beam_of(node);
    if (!reference) {
      instances.push_back(std::move(own));
      below(node, instances.size() - 1, offsets);
      return;
    }
    const std::string target_name = plain_attribute(node, "Geometry");
    const pugi::xml_node target = top_level(target_name);
    if (!target) {
      problems_.add(xml_.place_of(node),
                    fmt::format("geometry reference {} names {}, which is no geometry at the top", in_quotes(name),
                                in_quotes(target_name)),
                    "correct the name in the fixture builder");
      return;
    }
    if (std::find(open_.begin(), open_.end(), target_name) != open_.end()) {
      problems_.add(xml_.place_of(node), fmt::format("geometry {} refers to itself", in_quotes(target_name)),
                    "remove the reference in the fixture builder");
      return;
    }
    const ReferenceOffsets inner = offsets_of(node, offsets);
    own.defined_as = target_name;
    own.added_by_break = inner.added_by_break;
    own.overwrite = inner.overwrite;
    if (std::string_view(target.name()) == "Beam") own.geometry.beam = beam_of(target);
    instances.push_back(std::move(own));
    open_.push_back(target_name);
    below(target, instances.size() - 1, inner);
    open_.pop_back();
  }

  std::vector<GdtfInstance> instances;

 private:
  bool full() {
    if (instances.size() < kMaxInstances) return false;
    if (!told_full_) {
      problems_.add(xml_.place_of(geometries_), fmt::format("more than {} geometries in a mode", kMaxInstances),
                    "no such fixture is known; do not trust the file");
    }
    told_full_ = true;
    return true;
  }

  void below(const pugi::xml_node& node, std::size_t index, const ReferenceOffsets& offsets) {
    for (const pugi::xml_node& child : node.children())
      if (is_geometry(child)) walk(child, index, offsets);
  }

  pugi::xml_node top_level(const std::string& name) const {
    for (const pugi::xml_node& node : geometries_.children())
      if (is_geometry(node) && plain_attribute(node, "Name") == name) return node;
    return {};
  }

  const XmlFile& xml_;
  pugi::xml_node geometries_;
  ProblemList& problems_;
  std::vector<std::string> open_;
  bool told_full_ = false;
};

pugi::xml_node geometry_named(const pugi::xml_node& geometries, const std::string& name) {
  return geometries.find_node(
      [&](const pugi::xml_node& node) { return is_geometry(node) && plain_attribute(node, "Name") == name; });
}

/// Pose of a geometry in the frame of one above it, or in the fixture's frame if none is given.
Pose pose_in(const std::vector<GdtfInstance>& instances, std::optional<std::size_t> above, std::size_t below) {
  Pose pose;
  for (std::optional<std::size_t> at = below; at && at != above; at = instances[*at].geometry.parent) {
    const Pose& outer = instances[*at].parent_from_self;
    pose.translation_m = outer.rotation * pose.translation_m + outer.translation_m;
    pose.rotation = outer.rotation * pose.rotation;
  }
  return pose;
}

bool turns_about_z(const Mat3& m) { return (m.col(2) - Vec3::UnitZ()).norm() < kStraight; }
double turn_about_z_deg(const Mat3& m) { return deg_from_rad(std::atan2(m(1, 0), m(0, 0))); }

bool lies_below(const std::vector<GdtfInstance>& instances, std::size_t inner, std::size_t outer) {
  for (std::optional<std::size_t> at = inner; at; at = instances[*at].geometry.parent)
    if (*at == outer) return true;
  return false;
}

}  // namespace

std::vector<GdtfInstance> gdtf_instances(const XmlFile& xml, const pugi::xml_node& geometries,
                                         const std::string& root_name, const FilePosition& in_file,
                                         ProblemList& problems) {
  const pugi::xml_node root = geometry_named(geometries, root_name);
  if (!root) {
    problems.add(in_file, fmt::format("the mode's geometry {} does not exist", in_quotes(root_name)),
                 "choose one of the fixture's geometries in the fixture builder");
    return {};
  }
  GeometryWalk walk(xml, geometries, problems);
  walk.walk(root, std::nullopt, {});
  return std::move(walk.instances);
}

void set_gdtf_axes(const std::vector<GdtfInstance>& instances, std::optional<std::size_t> pan,
                   std::optional<std::size_t> tilt, PersonalityMode& mode) {
  if (!pan || !tilt) {
    for (std::size_t i = 0; i < instances.size(); ++i) {
      if (!instances[i].geometry.beam) continue;
      mode.base_from_lamp = pose_in(instances, std::nullopt, i);
      return;
    }
    return;
  }
  const Pose to_pan = pose_in(instances, std::nullopt, *pan);
  if (*pan == *tilt || !lies_below(instances, *tilt, *pan)) {
    mode.axes_problem = "its tilt does not ride on its pan";
    return;
  }
  const Pose to_tilt = pose_in(instances, pan, *tilt);
  mode.base_from_lamp.translation_m = pose_in(instances, std::nullopt, *tilt).translation_m;
  if (!turns_about_z(to_pan.rotation) || !turns_about_z(to_tilt.rotation)) {
    mode.axes_problem =
        "its pan does not turn about the vertical of a base that hangs straight, or its tilt not across it";
    return;
  }
  Vec3 beam = -Vec3::UnitZ();
  for (std::size_t i = 0; i < instances.size(); ++i) {
    if (!instances[i].geometry.beam || !lies_below(instances, i, *tilt)) continue;
    beam = pose_in(instances, tilt, i).rotation * beam;
    break;
  }
  if (std::abs(beam.x()) > kStraight) {
    mode.axes_problem = "its beam does not leave at a right angle to its tilt axis";
    return;
  }
  mode.pan_offset_deg = turn_about_z_deg(to_pan.rotation) + turn_about_z_deg(to_tilt.rotation);
  mode.tilt_offset_deg = deg_from_rad(std::atan2(beam.y(), -beam.z()));
}

}  // namespace luxrig
