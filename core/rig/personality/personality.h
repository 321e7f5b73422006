#pragma once
/// Content of a maker's fixture file: the modes, and the function of every DMX channel in each.
///
/// GDTF files (DIN SPEC 15800) and Open Fixture Library files fill the same values (personality_file.h). Functions have
/// GDTF attribute names ("Dimmer", "Pan", "ColorAdd_R", "Shutter1", "LampControl"); those of OFL files are translated.
/// DMX values are in the resolution of their channel: 0…255, 0…65535, …

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

struct DmxInterval {
  std::uint32_t from = 0, to = 0;  ///< both inclusive
  [[nodiscard]] bool contains(std::uint32_t value) const { return value >= from && value <= to; }
  [[nodiscard]] std::uint32_t middle() const { return from + (to - from) / 2; }
  bool operator==(const DmxInterval&) const = default;
};

/// A named part of a function's range: a slot of a wheel, an open shutter.
struct ChannelSet {
  std::string name;  ///< may be empty
  DmxInterval dmx;
  double physical_from = 0, physical_to = 1;
};

/// The function exists only while another channel's value is in a range (GDTF: ModeMaster).
struct FunctionCondition {
  std::size_t channel = 0;  ///< index in the mode
  DmxInterval dmx;          ///< in that channel's resolution
};

struct ChannelFunction {
  std::string attribute;
  std::string name;
  DmxInterval dmx;
  std::uint32_t default_dmx = 0;
  double physical_from = 0, physical_to = 1;  ///< at dmx.from and dmx.to; degrees for angles, share for levels
  std::string emitter;                        ///< name in the file; empty = not named
  std::optional<std::size_t> profile;         ///< in Personality::profiles: how physical follows DMX, if not linear
  std::optional<FunctionCondition> when;
  double hold_s = 0;       ///< time that a command must be held before it is obeyed; 0 = not stated
  double real_fade_s = 0;  ///< from one end of its range to the other; 0 = not stated
  std::vector<ChannelSet> sets;

  /// requires dmx.contains(value)
  [[nodiscard]] double physical_at(std::uint32_t value) const;
  /// The set that contains the value; null if the file names none there.
  [[nodiscard]] const ChannelSet* set_at(std::uint32_t value) const;
};

struct PersonalityChannel {
  std::string name;
  std::size_t geometry = 0;  ///< in PersonalityMode::geometries: the part it acts on
  int dmx_break = 1;         ///< the fixture's address that its offsets count from
  std::vector<int> offsets;  ///< of its slots from that address, 0-based, most significant first; none = virtual
  std::uint32_t default_dmx = 0;
  std::optional<std::uint32_t> highlight_dmx;
  std::vector<ChannelFunction> functions;

  [[nodiscard]] bool is_virtual() const { return offsets.empty(); }
  /// 255, 65535, …; a virtual channel counts in four bytes.
  [[nodiscard]] std::uint32_t max_dmx() const;
};

/// Where light leaves.
struct BeamGeometry {
  double lumens = 0;
  double beam_angle_deg = 0, field_angle_deg = 0;  ///< full angles to 50 % and 10 %
  double cct_k = 0;
  double power_w = 0;
};

/// A part that channels act on. The first is the whole fixture. OFL: the whole, and each pixel.
struct GeometryInstance {
  std::string name;
  std::optional<std::size_t> parent;
  std::optional<BeamGeometry> beam;
};

enum class RelationKind { multiply, override_follower };
struct ChannelRelation {
  std::size_t master = 0, follower = 0;  ///< channels of the mode
  RelationKind kind = RelationKind::multiply;
};

struct PersonalityMode {
  std::string name;
  std::vector<int> break_footprints;  ///< slots used from each address of the fixture; nearly all have one
  std::vector<GeometryInstance> geometries;
  std::vector<PersonalityChannel> channels;
  std::vector<ChannelRelation> relations;
  /// Added to a physical angle to convert it to the rig file's: tilt from straight down, pan from the base's y.
  double pan_offset_deg = 0, tilt_offset_deg = 0;
  std::string axes_problem;  ///< why its pan and tilt cannot be computed with; empty = they can
  /// Where light leaves. Of a head: its pivot, with the base not turned. Of a fixture that does not move: its lamp.
  Pose base_from_lamp;

  [[nodiscard]] int footprint() const { return break_footprints.empty() ? 0 : break_footprints.front(); }
  /// Whether one is inside the other, or they are the same.
  [[nodiscard]] bool share_a_branch(std::size_t geometry_a, std::size_t geometry_b) const;
};

/// Piecewise cubic, GDTF's DMXProfile. From each point on, y = c0 + c1·x + c2·x² + c3·x³, where x is the share of the
/// range since that point.
struct DmxProfile {
  struct Piece {
    double from = 0;  ///< share of the DMX range, 0…1
    double c[4] = {0, 0, 0, 0};
  };
  std::string name;
  std::vector<Piece> pieces;  ///< by `from`, rising
  [[nodiscard]] double at(double share) const;
};

/// The light of all beams of a mode together: fluxes and powers added, angles and colour from the first. All 0 if the
/// file states none; OFL files never do.
[[nodiscard]] BeamGeometry light_of_mode(const PersonalityMode& mode);

struct Personality {
  std::string manufacturer, name;
  std::vector<PersonalityMode> modes;
  std::vector<DmxProfile> profiles;
  std::vector<std::string> notes;  ///< oddities of the file, and how they were read
};

/// An attribute without its number: "Shutter1" -> "Shutter".
[[nodiscard]] std::string_view attribute_stem(std::string_view attribute);

/// Emitter of an additive colour attribute: "red" for ColorAdd_R, "amber" for ColorAdd_RY; empty for any other.
[[nodiscard]] std::string_view emitter_of_attribute(std::string_view attribute);
/// Whether the function is the level of that emitter. Ignores case, blanks, - and _.
[[nodiscard]] bool sets_emitter(const ChannelFunction& function, std::string_view emitter);

/// Effect of a shutter function on the light.
enum class ShutterState { open, closed, unsteady };
/// nullopt if it is not a shutter function.
[[nodiscard]] std::optional<ShutterState> shutter_state(const ChannelFunction& function, std::uint32_t value);

/// Whether the value strikes the lamp.
[[nodiscard]] bool strikes_lamp(const ChannelFunction& function, std::uint32_t value);

/// Whether `text` contains `word`, ignoring case.
[[nodiscard]] bool says(std::string_view text, std::string_view word);

}  // namespace luxrig
