#pragma once
/// What was learnt of a rig that its file does not say, or says wrongly: a value, and a file beside the rig file. It is
/// applied over the rig and never written into the rig file.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry.h"
#include "core/result.h"
#include "core/rig/rig.h"

namespace luxrig {

/// With its standard error; 0 = not measured, taken from the rig file.
struct Known {
  double value = 0, standard_error = 0;
  friend bool operator==(const Known&, const Known&) = default;
};

/// How a head turns (core/rig/joint_map.h). The zero of its pan is in the turn of its mount.
struct CalibratedHead {
  bool upside_down = false;                 ///< over the rig file
  Known pan_scale{1, 0}, tilt_scale{1, 0};  ///< true over sent; negative: it turns the other way
  Known tilt_zero_deg{}, askew_deg{};       ///< how its beam lies in its lamp: along the tilt, and across
  Known pan_backlash_deg{}, tilt_backlash_deg{};
  Known pan_speed_deg_s{}, tilt_speed_deg_s{};  ///< 0 = not measured
  Known settling_s{};                           ///< from its stated arrival until its beam stands still
};

/// The output that a lamp was first found to have; what it has lost since is its ageing.
struct FirstOutput {
  std::string since;   ///< when, UTC
  Known output{1, 0};  ///< true over rated flux, > 0
};

struct CalibratedFixture {
  std::string name;
  Known output{1, 0};                  ///< true over rated flux, > 0
  std::optional<FirstOutput> first{};  ///< by an earlier calibration of the same lamp
  /// How its mount hangs off the rig file's place, along and about world x, y, z. Emitters of one housing hang together.
  Vec3 offset_m = Vec3::Zero(), offset_error_m = Vec3::Zero();
  Vec3 turn_deg = Vec3::Zero(), turn_error_deg = Vec3::Zero();
  std::optional<CalibratedHead> head{};  ///< then its mount is known by it
  MeasuredCurve curve{};   ///< empty = the rig file's is right
  double curve_error = 0;  ///< standard error of a share of about 0.4, relative
};

struct CalibratedMaterial {
  std::string name;         ///< of the built scene
  Known reflectance{1, 0};  ///< true over stated, > 0
};

struct CalibratedLuxmeter {
  std::string name;
  Known gain{1, 0};  ///< reading over light, > 0
};

/// How a camera hangs, and how it shows light (core/calibration/camera_instrument.h).
struct CalibratedCamera {
  std::string name;
  /// Off the rig file's place, along and about world x, y, z.
  Vec3 offset_m = Vec3::Zero(), offset_error_m = Vec3::Zero();
  Vec3 turn_deg = Vec3::Zero(), turn_error_deg = Vec3::Zero();
  Known fov_deg{};     ///< from the top to the bottom of its picture, without distortion
  Known distortion{};  ///< core/picture/picture.h: Camera
  std::array<Known, 3>
      lens_loss{};  ///< it shows e^(-(a ρ² + b ρ⁴ + c ρ⁶)) of what it shows in the middle; ρ = 1 in a corner
  Known flare{}, halo{};  ///< shares of stray light, over the picture and around each pixel
  /// Per kind of lamp that it was tried on, by the luminaire's name: what it shows over the light, > 0.
  std::vector<std::pair<std::string, Known>> responses{};
};

/// Light of one fixture at full level at one point, at the aims of the rig file.
struct CalibratedLight {
  std::string point, fixture;
  Known lux;
};

struct Calibration {
  std::string rig;
  std::string made;            ///< when, UTC, as 2026-11-28T06:12:00Z
  std::uint64_t made_for = 0;  ///< RigVersion::light of the rig file then
  /// RigVersion::light of the rig as it was found to be: `lights` hold as long as that is the same; 0 = they do not.
  std::uint64_t as_found = 0;
  std::string simulated;       ///< which simulated rig was measured: "real, seed 1"; empty = the real one
  std::vector<CalibratedFixture> fixtures;
  std::vector<CalibratedMaterial> materials;
  std::vector<CalibratedLuxmeter> luxmeters;
  std::vector<CalibratedLight> lights;
  std::vector<CalibratedCamera> cameras{};
};

/// JSON, "luxrig_calibration": 1. A key for each entry's name, so that two files can be compared line by line.
/// The same value gives the same bytes.
[[nodiscard]] std::string to_json(const Calibration& calibration);
/// Never throws. Problems have line and column. Unknown keys are ignored, since later versions add some.
[[nodiscard]] Checked<Calibration> calibration_from_json(const std::string& text, const std::string& file_name);

/// The rig as it was found to be: outputs, mounts, reflectances and curves, and what is still uncertain of them. Heads
/// turn to where they shall look from their true place. Its cameras light nothing, and stay as in the rig file. A problem
/// for each fixture that the rig does not have, for an aim out of reach, and for another rig's calibration.
[[nodiscard]] Checked<Rig> calibrated(Rig rig, const Calibration& calibration, const std::string& file_name);

/// Where a rig's calibration is kept.
[[nodiscard]] std::filesystem::path calibration_file(const Rig& rig);

}  // namespace luxrig
