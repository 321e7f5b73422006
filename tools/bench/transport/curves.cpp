/// Time against error: every method at several settings in every room, and the fastest setting that meets a target.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/rig/rig_file.h"
#include "core/tasks/rig_transport.h"
#include "core/tasks/scene_builder.h"
#include "tools/bench/transport/case.h"

namespace luxrig {
namespace {

struct Target {
  const char* room;
  const char* method;
  double error, seconds;
};
/// A run longer than this is the last of its method: finer ones would each take several times as long.
constexpr double kLongestCurveSeconds = 20;

constexpr Target kTargets[] = {{"flat", "gather", 0.01, 0.5},
                               {"flat", "gather", 0.003, 5},
                               {"gallery", "gather", 0.01, 0.5},
                               {"gallery", "gather", 0.003, 5}};

struct Point {
  double wanted = 0;
  RoomError error;
  Measured run;  ///< with the median time
};

/// Medians of `repeats` runs with different seeds, separately for error and time.
Point measured_at(const TransportCase& one, const Method& method, const Reference& reference, double wanted,
                  int repeats, const BenchOptions& options) {
  std::vector<Point> points;
  for (int i = 0; i < repeats; ++i) {
    Point point;
    EvaluateOptions evaluate;
    evaluate.wanted_relative_error = evaluate.wanted_rms_error = wanted;
    evaluate.seed = static_cast<std::uint64_t>(i + 1);
    evaluate.threads = options.threads;
    if (options.quick) evaluate.max_rays = 8'000'000;
    point.wanted = wanted;
    point.run = measure(method, one.rays, one.room.receivers, one.room.emitters, evaluate);
    if (point.run.refused.empty())
      point.error = error_of(point.run.matrix.lux(Eigen::VectorXd::Ones(point.run.matrix.emitters())), reference.lux);
    points.push_back(std::move(point));
    if (points.back().run.seconds > kLongestCurveSeconds) break;
  }
  const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
  std::nth_element(points.begin(), middle, points.end(),
                   [](const Point& a, const Point& b) { return a.error.rms < b.error.rms; });
  const RoomError error = middle->error;
  std::nth_element(points.begin(), middle, points.end(),
                   [](const Point& a, const Point& b) { return a.run.seconds < b.run.seconds; });
  Point median = std::move(*middle);
  median.error = error;
  return median;
}

/// Direct light of every method compared with the direct evaluator's, which is exact for lamps without size.
void add_direct_curve(const TransportCase& one, const BenchOptions& options, std::vector<BenchRow>& rows) {
  EvaluateOptions evaluate;
  evaluate.wanted_relative_error = 0.3;
  evaluate.threads = options.threads;
  evaluate.max_rays = 3'000'000;
  Eigen::VectorXd exact_lx;
  for (const Method& method : methods()) {
    const Measured run = measure(method, one.rays, one.room.receivers, one.room.emitters, evaluate);
    double error = 0;
    if (run.refused.empty()) {
      const Eigen::VectorXd lux = run.matrix.direct_lux(Eigen::VectorXd::Ones(run.matrix.emitters()));
      if (exact_lx.size() == 0) exact_lx = lux;
      error = (lux - exact_lx).cwiseAbs().maxCoeff() / exact_lx.maxCoeff();
    }
    rows.push_back(transport_row(one.room.name + "-direct", method.name, error, run, std::nullopt, 1e-9));
  }
}

void add_curves(const TransportCase& one, const BenchOptions& options, std::vector<BenchRow>& rows) {
  add_direct_curve(one, options, rows);
  const Reference reference = reference_of(one, options);
  if (!reference.refused.empty()) {
    Measured none;
    none.refused = reference.refused;
    rows.push_back(transport_row(one.room.name, "path", 0, none, std::nullopt, std::nullopt));
    return;
  }
  const std::vector<double> settings =
      options.quick ? std::vector<double>{0.1, 0.04, 0.02, 0.012, 0.006}
                    : std::vector<double>{0.1, 0.04, 0.02, 0.012, 0.0105, 0.0095, 0.008, 0.004, 0.0028};
  for (const Method& method : methods()) {
    if (!method.reflects || (!options.method.empty() && options.method != method.name)) continue;
    std::vector<Point> points;
    for (const double wanted : settings) {
      points.push_back(measured_at(one, method, reference, wanted, options.quick ? 1 : 3, options));
      const Point& point = points.back();
      rows.push_back(transport_row(one.room.name, method.name, point.error.rms, point.run, wanted, std::nullopt,
                                   point.error, reference.rms_error));
      if (!point.run.refused.empty() || point.run.seconds > kLongestCurveSeconds) break;
    }
    for (const Target& target : kTargets) {
      if (one.room.name != target.room || std::string(method.name) != target.method) continue;
      if (options.quick && target.error < 0.01) continue;
      // The fastest setting with a small enough error, else the one with the smallest error.
      const Point* best = nullptr;
      for (const Point& point : points) {
        const bool enough = point.error.rms <= target.error, had = best && best->error.rms <= target.error;
        if (!best || (enough && (!had || point.run.seconds < best->run.seconds)) ||
            (!enough && !had && point.error.rms < best->error.rms))
          best = &point;
      }
      BenchRow row = transport_row(fmt::format("{}-to-{:g}", one.room.name, target.error), method.name, best->error.rms,
                                   best->run, best->wanted, target.error, best->error, reference.rms_error);
      row.target_seconds = target.seconds;
      rows.push_back(row);
    }
  }
}

/// A rig's scene, fixtures and points as a room.
std::optional<LitRoom> room_of_rig(const std::filesystem::path& file, std::vector<BenchRow>& rows) {
  const auto refuse = [&](const std::vector<Problem>& problems) {
    Measured none;
    none.refused = problems.front().text();
    rows.push_back(transport_row(file.parent_path().filename().string(), "-", 0, none, std::nullopt, std::nullopt));
    return std::nullopt;
  };
  const auto rig = load_rig(file);
  if (!rig) return refuse(rig.error());
  auto scene = build_scene(*rig);
  if (!scene) return refuse(scene.error());
  const auto folder = std::filesystem::absolute(file).lexically_normal().parent_path().filename();
  return LitRoom{"rig-" + folder.string(), std::move(*scene), emitters_of(*rig), receivers_of(*rig)};
}

}  // namespace

void add_curve_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  const std::pair<const char*, LitRoom (*)()> kRooms[] = {{"box", [] { return make_box_room(); }},
                                                          {"flat", [] { return make_eight_room_flat(); }},
                                                          {"gallery", [] { return make_gallery_hall(); }},
                                                          {"atrium", [] { return make_atrium(); }}};
  for (const auto& [name, make] : kRooms)
    if (wanted_case(options, name)) add_curves(TransportCase(make()), options, rows);
  for (const std::filesystem::path& rig : options.rigs)
    if (auto room = room_of_rig(rig, rows)) add_curves(TransportCase(std::move(*room)), options, rows);
}

}  // namespace luxrig
