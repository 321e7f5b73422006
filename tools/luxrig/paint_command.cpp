// paint: light painted on surfaces, as strokes in a file and the points that follow from them.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/goals/painting_file.h"
#include "core/picture/rig_camera.h"
#include "core/rig/rig_file.h"
#include "core/tasks/surface_goals.h"
#include "core/text/nearest.h"
#include "core/text/plain_text.h"
#include "tools/command_line/completion.h"
#include "tools/command_line/installed.h"
#include "tools/luxrig/commands.h"
#include "tools/luxrig/painting_files.h"
#include "tools/luxrig/room_view.h"
#include "tools/process/files.h"
#include "tools/terminal/command.h"
#include "tools/terminal/picture_png.h"
#include "tools/terminal/table.h"

namespace luxrig {
namespace {

struct PaintArguments {
  std::filesystem::path rig;
  std::string goal;  ///< empty = all
  std::vector<double> brush_m, bucket_m, selective_m, erase_m, pick_m, from_m;
  std::optional<double> lux, radius_m, falloff;
  int undo = 0;  ///< strokes
  std::optional<std::filesystem::path> picture;
  std::string camera;  ///< empty = one that shows the room
  int threads = 0;
  bool json = false;
};

std::optional<StrokeKind> stroke_kind(const PaintArguments& arguments) {
  if (!arguments.brush_m.empty()) return StrokeKind::brush;
  if (!arguments.bucket_m.empty()) return StrokeKind::bucket;
  if (!arguments.selective_m.empty()) return StrokeKind::selective;
  if (!arguments.erase_m.empty()) return StrokeKind::eraser;
  return std::nullopt;
}

std::vector<Vec3> places_of(std::span<const double> numbers) {
  std::vector<Vec3> places;
  for (std::size_t k = 0; k + 2 < numbers.size(); k += 3)
    places.emplace_back(numbers[k], numbers[k + 1], numbers[k + 2]);
  return places;
}

std::optional<Vec3> viewer_of(const PaintArguments& arguments) {
  return arguments.from_m.empty() ? std::nullopt : std::optional(places_of(arguments.from_m).front());
}

/// The stroke that the arguments ask for; none = no stroke.
Result<std::optional<Stroke>> stroke_of(const PaintArguments& arguments, const Session& session) {
  const auto kind = stroke_kind(arguments);
  if (!kind) return std::optional<Stroke>{};
  Stroke stroke;
  stroke.kind = *kind;
  if (*kind != StrokeKind::eraser) {
    if (!arguments.lux) return refusal("a stroke needs its light: --lux");
    stroke.lux = *arguments.lux;
  }
  if (*kind == StrokeKind::brush) {
    if (!arguments.radius_m) return refusal("a brush needs its size: --radius");
    stroke.radius_m = *arguments.radius_m;
    stroke.falloff = arguments.falloff.value_or(0);
  }
  for (const auto* numbers : {&arguments.brush_m, &arguments.bucket_m, &arguments.selective_m, &arguments.erase_m})
    for (const Vec3& place : places_of(*numbers)) {
      auto there = place_on_surface(session, place, viewer_of(arguments));
      if (!there) return tl::unexpected(there.error());
      stroke.path.push_back(*there);
    }
  return std::optional(std::move(stroke));
}

/// Whose fault is what was typed.
int refuse(const std::string& why) {
  fmt::print(stderr, "luxrig: {}\n", why);
  return kExitBadInput;
}

/// What the goals ask of every surface in view, as a PNG; surfaces without paint are grey. A surface that two goals paint
/// shows the first.
std::string picture_of(const PaintArguments& arguments, const Session& session,
                       std::span<const SurfacePainter::Painted> painted) {
  const Rig& rig = session.rig;
  constexpr int kWidth_px = 960, kHeight_px = 600;
  constexpr double kDarkest = 0.15, kLightest = 0.75;
  const auto named = std::find_if(rig.cameras.begin(), rig.cameras.end(),
                                  [&](const PictureCamera& each) { return each.name == arguments.camera; });
  const Camera camera = named != rig.cameras.end() ? view_of(*named)
                                                   : automatic_camera(*session.rays, rig, hung_look(rig).joints,
                                                                      kWidth_px, kHeight_px, rad_from_deg(60));
  Picture picture;
  picture.width_px = camera.width_px;
  picture.height_px = camera.height_px;
  const auto pixels = static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
  picture.illuminance_lx.assign(pixels, -1);
  std::vector<float> grey(pixels, 0);
  std::size_t pixel = 0;
  for (int y = 0; y < camera.height_px; ++y)
    for (int x = 0; x < camera.width_px; ++x, ++pixel) {
      const Vec3 direction = ray_direction(camera, x + 0.5, y + 0.5);
      const auto hit = session.rays->nearest(camera.eye_world_m, direction, Vec3::Zero());
      if (!hit) continue;
      grey[pixel] = static_cast<float>(kDarkest + (kLightest - kDarkest) * std::abs(hit->normal_world.dot(direction)));
      for (const auto& goal : painted)
        if (const auto lux = goal.painting->lux_at({hit->position_world_m, hit->normal_world})) {
          picture.illuminance_lx[pixel] = static_cast<float>(*lux);
          break;
        }
    }
  return false_colour_png(picture, rig.name + ": light asked for", {"lux", 2, std::nullopt, grey});
}

struct Row {
  const SurfaceGoalSpec* goal;
  std::size_t strokes, points;
  double area_m2;
  std::optional<std::pair<double, double>> lux_range;
};

void print_rows(const std::vector<Row>& rows, bool as_json) {
  if (as_json) {
    nlohmann::ordered_json out;
    out["surface_goals"] = nlohmann::ordered_json::array();
    for (const Row& row : rows) {
      nlohmann::ordered_json one = {
          {"name", row.goal->name}, {"strokes", row.strokes}, {"area_m2", row.area_m2}, {"points", row.points}};
      if (row.lux_range) {
        one["lowest_lux"] = row.lux_range->first;
        one["highest_lux"] = row.lux_range->second;
      }
      out["surface_goals"].push_back(std::move(one));
    }
    fmt::print("{}\n", out.dump(1));
    return;
  }
  Table table({"surface goal", ">strokes", ">painted m²", ">lx", ">points", "points in"});
  for (const Row& row : rows) {
    std::string lux;
    if (row.lux_range) lux = fmt::format("{:g}", row.lux_range->first);
    if (row.lux_range && row.lux_range->second > row.lux_range->first)
      lux += fmt::format("-{:g}", row.lux_range->second);
    table.row({row.goal->name, fmt::format("{}", row.strokes), fmt::format("{:.2f}", row.area_m2), lux,
               fmt::format("{}", row.points), row.goal->points_file().filename().string()});
  }
  fmt::print("{}", table.text());
}

/// Paints one goal, and keeps what follows. stroke: added on top.
Result<Row> paint_goal(const SurfaceGoalSpec& goal, std::vector<Stroke> strokes, const std::optional<Stroke>& stroke,
                       bool strokes_changed, SurfacePainter& painter, std::vector<SurfacePainter::Painted>& all) {
  auto painted = painter.paint(goal, strokes);
  if (!painted) return tl::unexpected(painted.error());
  if (stroke) {
    painted->painting->add(*stroke);
    if (painted->painting->changed().empty())
      return refusal(stroke->kind == StrokeKind::eraser
                         ? "nothing is painted there"
                         : "the stroke would change nothing: it has the same light already");
    strokes.assign(painted->painting->strokes().begin(), painted->painting->strokes().end());
  }
  const std::vector<Point> points = points_of(goal, *painted);
  // Strokes of a person's hand stay as they are written.
  const auto written =
      strokes_changed ? save_painting(goal, painting_to_json(strokes), points) : save_points(goal, points);
  if (!written) return tl::unexpected(written.error());
  Row row{&goal, strokes.size(), points.size(), painted->area_m2(), painted->lux_range()};
  all.push_back(std::move(*painted));
  return row;
}

int run_paint(const PaintArguments& arguments) {
  if (arguments.picture && arguments.picture->extension() != ".png")
    return refuse(fmt::format("{} is no name of a PNG: end it in .png", arguments.picture->string()));
  auto rig = load_rig(arguments.rig, PaintedPoints::left_out);
  if (!rig) return report(rig.error());
  const auto session = session_of(std::move(*rig));
  if (!session) return report(session.error());
  const std::vector<SurfaceGoalSpec>& goals = session->rig.surface_goals;
  const auto named = std::find_if(goals.begin(), goals.end(),
                                  [&](const SurfaceGoalSpec& each) { return each.name == arguments.goal; });
  if (goals.empty() || (!arguments.goal.empty() && named == goals.end())) {
    std::vector<std::string_view> names;
    for (const SurfaceGoalSpec& each : goals) names.push_back(each.name);
    const std::string name = arguments.goal.empty() ? "drawing" : arguments.goal;
    return refuse(fmt::format("{}: the rig has no surface goal{}: {}", session->rig.file.string(),
                              arguments.goal.empty() ? "" : " " + in_quotes(arguments.goal),
                              mend_for_unknown(name, names,
                                               fmt::format("add [[surface_goal]] with name = {} and strokes = {}",
                                                           in_quotes(name), in_quotes(name + ".json")))));
  }
  if (!arguments.camera.empty() && std::none_of(session->rig.cameras.begin(), session->rig.cameras.end(),
                                                [&](const auto& each) { return each.name == arguments.camera; }))
    return refuse(fmt::format("the rig has no camera {}", in_quotes(arguments.camera)));
  const auto stroke = stroke_of(arguments, *session);
  if (!stroke) return refuse(stroke.error().detail);
  SurfacePainter painter(*session, arguments.threads);
  std::vector<SurfacePainter::Painted> painted;
  std::vector<Row> rows;
  for (const SurfaceGoalSpec& goal : goals) {
    const bool this_one = goal.name == arguments.goal;
    if (!arguments.goal.empty() && !this_one && !arguments.picture) continue;
    auto strokes = strokes_of(goal);
    if (!strokes) return report(strokes.error());
    if (this_one && arguments.undo > 0) {
      if (strokes->size() < static_cast<std::size_t>(arguments.undo))
        return refuse(fmt::format("{} has {} strokes to take back", in_quotes(goal.name), strokes->size()));
      strokes->resize(strokes->size() - static_cast<std::size_t>(arguments.undo));
    }
    const auto& added = this_one ? *stroke : std::optional<Stroke>{};
    auto row =
        paint_goal(goal, std::move(*strokes), added, added || (this_one && arguments.undo > 0), painter, painted);
    if (!row) return row.error().cause == Cause::invalid ? refuse(row.error().detail) : report(row.error());
    rows.push_back(*row);
  }
  print_rows(rows, arguments.json);
  if (!arguments.pick_m.empty()) {
    const auto place = place_on_surface(*session, places_of(arguments.pick_m).front(), viewer_of(arguments));
    if (!place) return refuse(place.error().detail);
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (const auto lux = painted[k].painting->lux_at(*place))
        fmt::print("{} asks for {:g} lx there\n", in_quotes(rows[k].goal->name), *lux);
  }
  if (!arguments.picture) return kExitOk;
  if (auto written = write_file(*arguments.picture, picture_of(arguments, *session, painted)); !written)
    return report(written.error());
  return kExitOk;
}

Action declare_paint(CLI::App& command) {
  const auto paint = std::make_shared<PaintArguments>();
  add_rig_option(command, paint->rig);
  auto* goal = command.add_option("goal", paint->goal, "a [[surface_goal]] by name (else all are laid out anew)");
  std::vector<CLI::Option*> strokes;
  const auto place = [&](const char* option, std::vector<double>& at_m, const char* what) {
    strokes.push_back(command.add_option(option, at_m, what)->needs(goal));
    return strokes.back();
  };
  place("--brush", paint->brush_m, "paint along x y z [x y z …] [m]")->type_size(3)->expected(1, 1000);
  place("--bucket", paint->bucket_m, "paint the whole surface at x y z [m]")->expected(3);
  place("--selective", paint->selective_m, "paint what is nearest to x y z [m] of those clicks on one surface")
      ->expected(3);
  place("--erase", paint->erase_m, "take away the uppermost stroke at x y z [m]")->expected(3);
  strokes.push_back(command.add_option("--undo", paint->undo, "take back so many strokes")
                        ->check(CLI::Range(1, 1000000))
                        ->needs(goal));
  for (CLI::Option* one : strokes)
    for (CLI::Option* other : strokes)
      if (one != other) one->excludes(other);
  command.add_option("--lux", paint->lux, "the light that a stroke asks for")
      ->check(CLI::Range(std::numeric_limits<double>::min(), kMaxStroke_lx));
  command.add_option("--radius", paint->radius_m, "of the brush [m]")->check(CLI::Range(0.0, 1000.0));
  command.add_option("--falloff", paint->falloff, "share of the radius over which the brush fades (0)")
      ->check(CLI::Range(0.0, 1.0));
  command.add_option("--from", paint->from_m, "x y z [m] from where the surface is looked at")->expected(3);
  command.add_option("--pick", paint->pick_m, "say what is asked for at x y z [m]")->expected(3);
  auto* picture =
      command.add_option("--picture", paint->picture, "what is asked for, in colours, as PNG")->check(offers_files());
  command.add_option("--camera", paint->camera, "a camera of the rig for it")->needs(picture);
  command.add_option("--threads", paint->threads, "threads (0: one per core)")->check(CLI::Range(0, 1024));
  command.add_flag("--json", paint->json, "print JSON");
  command.footer(
      "Strokes are kept beside the rig file, in the file that [[surface_goal]] names.\n"
      "The points that follow from them count as the rig's own: solve, run and\n"
      "calibrate ask for their lux. After the scene has changed, lay them out anew.");
  return [paint] { return run_paint(*paint); };
}

}  // namespace

const Command kPaintCommand{"paint", command_group::kSet, "goals painted on surfaces, stroke by stroke", declare_paint};

}  // namespace luxrig
