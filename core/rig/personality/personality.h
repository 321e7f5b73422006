#pragma once
/// What a maker's fixture file says of a fixture: its modes, and in each what every DMX channel does.
///
/// GDTF files (DIN SPEC 15800) and Open Fixture Library files fill the same values (personality_file.h). Functions are
/// named by GDTF's attributes ("Dimmer", "Pan", "ColorAdd_R", "Shutter1", "LampControl"); those of an OFL file are
/// translated. DMX values count in the resolution of their channel: 0…255, 0…65535, …

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

struct DmxInterval {
  std::uint32_t from = 0, to = 0;  ///< both within
  [[nodiscard]] bool contains(std::uint32_t value) const { return value >= from && value <= to; }
  [[nodiscard]] std::uint32_t middle() const { return from + (to - from) / 2; }
  bool operator==(const DmxInterval&) const = default;
};

/// A named part of a function's range: a wheel's slot, a shutter that is open.
struct ChannelSet {
  std::string name;  ///< may be empty
  DmxInterval dmx;
  double physical_from = 0, physical_to = 1;
};

/// The function exists only while another channel's value lies in a range (GDTF: ModeMaster).
struct FunctionCondition {
  std::size_t channel = 0;  ///< of the mode
  DmxInterval dmx;          ///< in that channel's resolution
};

struct ChannelFunction {
  std::string attribute;
  std::string name;
  DmxInterval dmx;
  std::uint32_t default_dmx = 0;
  double physical_from = 0, physical_to = 1;  ///< at dmx.from and dmx.to; degrees for angles, share for levels
  std::string emitter;                        ///< as the file calls it; empty: none is named
  std::optional<std::size_t> profile;         ///< of Personality::profiles: how physical follows DMX, when not straight
  std::optional<FunctionCondition> when;
  double hold_s = 0;       ///< how long a command must stand before it is obeyed; 0: not stated
  double real_fade_s = 0;  ///< from one end of its range to the other; 0: not stated
  std::vector<ChannelSet> sets;

  /// requires dmx.contains(value)
  [[nodiscard]] double physical_at(std::uint32_t value) const;
  /// The set that holds the value; none when the file names none there.
  [[nodiscard]] const ChannelSet* set_at(std::uint32_t value) const;
};

struct PersonalityChannel {
  std::string name;
  std::size_t geometry = 0;  ///< of PersonalityMode::geometries: what it acts on
  int dmx_break = 1;         ///< which of the fixture's addresses it counts from
  std::vector<int> offsets;  ///< of its slots from that address, 0-based, most significant first; none: virtual
  std::uint32_t default_dmx = 0;
  std::optional<std::uint32_t> highlight_dmx;
  std::vector<ChannelFunction> functions;

  [[nodiscard]] bool is_virtual() const { return offsets.empty(); }
  /// 255, 65535, …; a virtual channel counts in four bytes.
  [[nodiscard]] std::uint32_t max_dmx() const;
};

/// Light leaves here.
struct BeamGeometry {
  double lumens = 0;
  double beam_angle_deg = 0, field_angle_deg = 0;  ///< full angles to 50 % and 10 %
  double cct_k = 0;
  double power_w = 0;
};

/// A part that channels act on; the first is the whole fixture. OFL: the whole, and each pixel.
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
  std::vector<int> break_footprints;  ///< slots taken from each address of the fixture: one, for nearly all
  std::vector<GeometryInstance> geometries;
  std::vector<PersonalityChannel> channels;
  std::vector<ChannelRelation> relations;
  /// To add to a physical angle so that it counts as in the rig file: from straight down, pan from the base's y.
  double pan_offset_deg = 0, tilt_offset_deg = 0;
  std::string axes_problem;  ///< why its pan and tilt cannot be computed with; empty: they can
  /// Where light leaves: of a head its pivot, the base not turned; of a fixture that does not move, its lamp as it is.
  Pose base_from_lamp;

  [[nodiscard]] int footprint() const { return break_footprints.empty() ? 0 : break_footprints.front(); }
  /// Whether one lies within the other, or they are the same.
  [[nodiscard]] bool share_a_branch(std::size_t geometry_a, std::size_t geometry_b) const;
};

/// Piecewise cubic, GDTF's DMXProfile: from each point on, with x the share of the range since it,
/// y = c0 + c1·x + c2·x² + c3·x³.
struct DmxProfile {
  struct Piece {
    double from = 0;  ///< share of the DMX range, 0…1
    double c[4] = {0, 0, 0, 0};
  };
  std::string name;
  std::vector<Piece> pieces;  ///< rising
  [[nodiscard]] double at(double share) const;
};

/// The light of all of a mode's beams together: fluxes and powers added, angles and colour of the first. All 0 where
/// the file states none, as those of the Open Fixture Library.
[[nodiscard]] BeamGeometry light_of_mode(const PersonalityMode& mode);

struct Personality {
  std::string manufacturer, name;
  std::vector<PersonalityMode> modes;
  std::vector<DmxProfile> profiles;
  std::vector<std::string> notes;  ///< what was odd in the file and how it was taken
};

/// "Shutter1" -> "Shutter": an attribute without its number.
[[nodiscard]] std::string_view attribute_stem(std::string_view attribute);

/// What an additive colour attribute lights: "red" of ColorAdd_R, "amber" of ColorAdd_RY; empty for any other.
[[nodiscard]] std::string_view emitter_of_attribute(std::string_view attribute);
/// Whether the function is that emitter's level. Case, blanks, - and _ do not count.
[[nodiscard]] bool sets_emitter(const ChannelFunction& function, std::string_view emitter);

/// What light does in a function of a shutter.
enum class ShutterState { open, closed, unsteady };
/// Nothing when the function is no shutter's.
[[nodiscard]] std::optional<ShutterState> shutter_state(const ChannelFunction& function, std::uint32_t value);

/// Whether the value commands the lamp to be struck.
[[nodiscard]] bool strikes_lamp(const ChannelFunction& function, std::uint32_t value);

/// Whether text says so, whatever its case.
[[nodiscard]] bool says(std::string_view text, std::string_view word);

}  // namespace luxrig
