#pragma once
/// Makes the Rig from the document in one pass. Each read_… fills its part of `rig` and reports problems. Wrong entries
/// stay in place, so that references to them by name still resolve and one mistake gives one problem. Private to
/// core/rig.

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/photometry/light_colour.h"
#include "core/rig/patch_map.h"
#include "core/rig/points_csv.h"
#include "core/rig/problem_list.h"
#include "core/rig/reading/document.h"
#include "core/rig/reading/mode_slots.h"
#include "core/rig/reading/section.h"
#include "core/rig/rig_file.h"

namespace luxrig {

/// Entries of one kind by name.
class NameIndex {
 public:
  /// `kind` as in "two fixtures are called …".
  explicit NameIndex(std::string kind) : kind_(std::move(kind)) {}

  /// Reports a name that is already taken.
  void add(const std::string& name, std::size_t index, const FilePosition& in_file, ProblemList& problems);
  [[nodiscard]] std::optional<std::size_t> find(const std::string& name) const;
  /// Reads the key that names an entry; an unknown name is reported with the nearest known one.
  std::optional<std::size_t> read_reference(Section& section, std::string_view key) const;

 private:
  std::string kind_;
  struct Entry {
    std::size_t index;
    FilePosition in_file;
  };
  std::unordered_map<std::string, Entry> entries_;
};

/// Light of a luminaire as a maker's file states it, for values missing in the rig file.
struct StatedLight {
  BeamGeometry light;   ///< 0 = not stated
  std::string fixture;  ///< the fixture that the file is for
  std::string file;
  bool used = false;              ///< the luminaire uses some of it
  std::vector<std::string> told;  ///< which values were used and which were not
};

struct RigReader {
  RigReader(const NodeTable& document, const std::filesystem::path& file, std::filesystem::path folder_of_files,
            PaintedPoints painted_points)
      : root(document), folder(std::move(folder_of_files)), painted(painted_points), problems(file.string()) {
    rig.file = file;
  }

  const NodeTable& root;
  std::filesystem::path folder;
  PaintedPoints painted;
  ProblemList problems;
  Rig rig;
  NameIndex luminaires{"luminaire"}, buses{"bus"}, points{"point"}, objects{"scene object"},
      surface_goals{"surface goal"}, fixtures{"fixture"}, cameras{"camera"};
  PatchMap patches;
  /// Place of each point, in the rig file or the points file.
  std::vector<std::pair<std::string, FilePosition>> point_places;
  std::map<std::string, std::shared_ptr<const Personality>> personalities;  ///< by path; null = cannot be used
  std::map<std::string, std::shared_ptr<const RegisterMap>> register_maps;  ///< by path; null = cannot be used
  std::map<std::size_t, StatedLight> stated_lights;                         ///< by luminaire
  std::set<std::size_t> lacks_watts;                                        ///< luminaires for which this was reported

  void read_all();

 private:
  void read_scene();
  void read_luminaires();
  void read_buses();
  void read_points();
  void read_points_file(Section& section);
  void read_surface_goal(Section& section);
  /// Of a CSV file, for a line of the rig file.
  void add_points(PointsTable table, const std::filesystem::path& path, const FilePosition& in_file,
                  std::optional<std::size_t> surface_goal = {});
  void read_fixtures();
  void read_luxmeters();
  void read_daylight();
  void read_tasks();
  void read_placement(Section& section, PlacementSpec& placement);
  void read_placed(Section& section, TaskKind kind, std::size_t& luminaire, std::optional<int>& lights,
                   int& max_lights);
  void read_relief(Section& section, ReliefSpec& relief);
  void read_role(Section& section, ReliefSpec& relief);
  void refuse_roles_unseen(Section& section, const ReliefSpec& relief);
  /// A set-up has its own number of lights.
  void refuse_other_numbers(Section& section, const ReliefSpec& relief, const std::optional<int>& lights);
  void read_aim_task(Section& section, AimSpec& aim);
  void read_highlight(Section& section, HighlightSpec& highlight);
  void read_directions(Section& section, DirectionsSpec& directions);
  void read_number_of_lights(Section& section, std::optional<int>& lights, int& max_lights);
  /// Indices of the entries whose names match a key's patterns, rising. A pattern without a match is reported.
  [[nodiscard]] std::vector<std::size_t> read_patterns(Section& section, std::string_view key,
                                                       const std::vector<std::string_view>& names,
                                                       std::string_view what);
  void read_cameras();
  void read_picture_taking(Section& section, PictureTaking& taking);
  void read_mounting();
  void read_keep_outs();
  void read_startup();
  void read_settings();

  void each(const NodeTable& table, std::string_view section, const std::function<void(Section&)>& body);
  /// The path given by the key, if there is such a file.
  std::optional<std::filesystem::path> read_file(Section& section, std::string_view key);
  void read_mesh(Section& section, std::optional<MeshFile>& out);
  void read_box_or_mesh(Section& section, SceneObject& object);
  void read_distribution(Section& section, StatedLight& stated, Luminaire& luminaire);
  void check_model_keys(Section& section, LuminaireModel model, const StatedLight& stated);
  /// Light from the first [[fixture]] with that luminaire and a maker's file that states light; all 0 if there is none.
  /// Problems of that fixture or its file are reported when fixtures are read.
  [[nodiscard]] StatedLight light_stated_for(const std::string& luminaire);
  /// Fills in values missing in the section.
  static void take_stated_light(Section& section, StatedLight& stated, Luminaire& luminaire);
  /// Checks another fixture of the luminaire, in a mode with its own light. Reports light that differs from the light
  /// used.
  void check_stated_light(const Section& section, const Fixture& fixture, const PersonalityMode& mode);
  void read_spot(Section& section, Luminaire& luminaire);
  void read_photometric_file(Section& section, Luminaire& luminaire);
  void read_luminous_surface(Section& section, Luminaire& luminaire);
  void read_colour(Section& section, Vec3& colour_rgb);
  void note_colour_moved(const std::string& file, const FilePosition& in_file, const std::string& whose,
                         const Chromaticity& wanted, const Vec3& taken_rgb);
  /// Reads only the emitters' own keys.
  std::vector<Luminaire> read_emitters(Section& section, const std::string& luminaire_name);
  static void add_up(const std::vector<Luminaire>& emitters, Luminaire& luminaire);
  void read_goal(Section& section, Point& point);
  /// none = any
  [[nodiscard]] std::optional<Vec3> read_goal_colour(Section& section, const std::string& whose);
  [[nodiscard]] Vec3 goal_colour(const Chromaticity& xy, const std::string& file, const FilePosition& in_file,
                                 const std::string& whose);
  void check_goal_colours();
  /// Reports a luminaire without watts, once.
  void need_watts_of(std::size_t luminaire, const FilePosition& in_file, const std::string& what);
  void need_watts_of_fixtures(const FilePosition& in_file, const std::string& what);
  /// Reads the DMX patch, and its slots as named. True if they can be claimed. `of_mode`: set if a personality can be
  /// used.
  bool read_dmx(Section& section, const std::optional<SlotOwner>& owner, bool planned, Fixture& fixture,
                std::vector<NamedSlot>& named, std::optional<ModeSlots>& of_mode);
  std::shared_ptr<const Personality> read_personality(Section& section);
  /// Read once; null if it cannot be used, which read_personality() reports.
  std::shared_ptr<const Personality> personality_at(const std::filesystem::path& path);
  std::shared_ptr<const RegisterMap> read_register_map(Section& section);
  /// Reads the fixture's patch over Modbus. True if its registers can be claimed.
  bool read_modbus(Section& section, const std::optional<SlotOwner>& owner, Fixture& fixture);
  bool read_modbus_meter(Section& section, Luxmeter& meter);
  std::optional<std::size_t> read_mode(Section& section, const Personality& personality);
  std::optional<ModeSlots> read_slots_of_mode(Section& section, const std::optional<SlotOwner>& owner,
                                              Fixture& fixture);
  /// Reads pan and tilt that are drives on their own bus.
  void read_axes(Section& section, Fixture& fixture);
  void read_aim(Section& section, Fixture& fixture);
  /// For a fixture that cannot dim. Keys that need dimming are problems. `steps`: its maker's file says that it cannot.
  void read_switched(Section& section, bool has_emitters, bool steps, Fixture& fixture);
  /// Of keys "pan_deg" and "tilt_deg" with `prefix` in front.
  void check_joints(Section& section, const Fixture& fixture, const Joints& at, const std::string& prefix);
  void read_park(Section& section, Fixture& fixture);
};

}  // namespace luxrig
