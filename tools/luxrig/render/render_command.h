#pragma once
/// `luxrig render`: a picture of the lit rig, its lux in false colour, or why its lights are where they are.

#include <filesystem>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "core/picture/picture.h"
#include "core/plan/plan.h"
#include "core/run.h"
#include "tools/terminal/exposure.h"

namespace luxrig {

/// Pictures that explain; render_show.h says what each draws.
enum class ShowWhat { curvature, interest, features, histogram, domain, beams };

struct RenderOptions {
  std::filesystem::path rig;
  std::optional<std::filesystem::path> plan;  ///< none = every fixture at its highest allowed level
  std::filesystem::path output;               ///< .png or .jpg
  bool false_colour = false;                  ///< lux map with a scale
  int width_px = 960, height_px = 600;
  std::optional<std::string> camera;                ///< of the rig, from which it is seen
  bool sized = false;                               ///< width and height are asked for, not the camera's
  std::optional<Vec3> eye_world_m, target_world_m;  ///< none = a view of the room that shows most of its points
  std::optional<double> vertical_fov_deg;           ///< none = 60, for `show` 30
  std::optional<ShowWhat> show;                     ///< instead of the lit room
  std::optional<std::string> object;                ///< object with the relief; none = the only one from a mesh file
  int lights = 3;                                   ///< directions to choose on the histogram
  bool compare = false;                             ///< an object in three lights, instead of the room
  Exposure exposure;
  WhiteBalance white_balance;
  std::optional<double> max_lx;  ///< top of the false colour scale; none = from the picture
  double max_error = 0.02;       ///< noise at which the picture is done
  double seconds = 20;           ///< or after this time
  std::optional<int> passes;     ///< or after so many samples per pixel: the same picture each time
  int threads = 0;
};

/// The rig's camera of that name, none if none is asked for. Refuses an unknown name.
[[nodiscard]] Result<std::optional<Camera>> camera_named(const Rig& rig, const RenderOptions& options);

/// For `options.show`, which must be set. Returns the exit code: 0, 2 for bad input (with a message on stderr), 1 if
/// the file cannot be written.
int run_show(const RenderOptions& options);

/// One of so many pictures that share the options' time and a progress line.
struct PartOfPictures {
  Progress progress;
  std::stop_token stop;
  int number = 0, of = 1;
};
/// Ends when the picture's noise is as low as asked for, or its time is over.
[[nodiscard]] Result<Picture> picture_in_time(const RayScene& rays, const std::vector<Emitter>& emitters,
                                              const std::vector<double>& levels, const Camera& camera,
                                              const RenderOptions& options, const PartOfPictures& part);

/// As the options ask, or metered on `picture`. words: says so in a line.
[[nodiscard]] PhotographLook look_of(const RenderOptions& options, const Picture& picture,
                                     std::span<const Emitter> emitters, std::span<const double> levels,
                                     std::string& words);

/// The rig and its look: that of the plan, after its placed lights are hung; or each fixture at its highest level.
[[nodiscard]] Checked<HungPlan> load_rig_for_picture(const RenderOptions& options);

}  // namespace luxrig
