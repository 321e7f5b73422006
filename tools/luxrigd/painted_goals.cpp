#include "tools/luxrigd/painted_goals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <system_error>

#include "core/fingerprint.h"
#include "core/goals/painting_file.h"
#include "core/text/nearest.h"
#include "core/text/plain_text.h"
#include "tools/luxrig/painting_files.h"
#include "tools/luxrigd/api/patch_file.h"
#include "tools/luxrigd/new_surface_goal.h"
#include "tools/luxrigd/scheduling.h"

namespace luxrig {

using Why = PaintingRefusal::Why;

struct PaintedGoals::Surfaces {
  explicit Surfaces(std::shared_ptr<const Session> of) : session(std::move(of)), painter(*session) {}
  std::shared_ptr<const Session> session;
  SurfacePainter painter;  ///< of the maker's thread alone
};

struct PaintedGoals::Goal {
  SurfaceGoalSpec spec;
  bool in_force = true;
  PaintingDocument document;
  std::string on_disk;  ///< version of the strokes in its file
  std::optional<std::filesystem::file_time_type> read_at;
  bool read = false;
  std::string trouble, unpaintable;  ///< why there are no strokes; no patches
  std::shared_ptr<Surfaces> surfaces;
  std::optional<SurfacePainter::Painted> painted;
  std::shared_ptr<const KeptAnswer> patch_file;
  std::string patch_file_of;  ///< version

  void forget() {
    painted.reset();
    surfaces.reset();
    patch_file.reset();
    unpaintable.clear();
  }
};

namespace {

constexpr auto kForgotten = std::chrono::minutes(10);
constexpr std::size_t kMaxStrokes = 10000;
/// Patches that new brushes may meet, over all pieces of their paths: some seconds.
constexpr double kMaxPatchVisits = 1e8;

tl::unexpected<PaintingRefusal> refused_since(Why why, std::string text) {
  return tl::unexpected(PaintingRefusal{why, std::move(text), {}});
}

std::string version_of_strokes(const std::string& text) {
  Fingerprint print;
  print.add(std::string_view(text));
  return fmt::format("{:016x}", print.value());
}

std::optional<std::filesystem::file_time_type> written_at(const std::filesystem::path& file) {
  std::error_code error;
  const auto time = std::filesystem::last_write_time(file, error);
  return error ? std::nullopt : std::optional(time);
}

std::size_t common_start(const std::vector<Stroke>& a, const std::vector<Stroke>& b) {
  return static_cast<std::size_t>(std::mismatch(a.begin(), a.end(), b.begin(), b.end()).first - a.begin());
}

/// b is the brush a with a longer path.
bool goes_on(const Stroke& a, const Stroke& b) {
  return a.kind == StrokeKind::brush && b.kind == a.kind && a.lux == b.lux && a.radius_m == b.radius_m &&
         a.falloff == b.falloff && a.path.size() < b.path.size() &&
         std::equal(a.path.begin(), a.path.end(), b.path.begin());
}

/// At most so many patches are met while this brush is worked out, about: those around its path, for each piece of it.
double patch_visits(const Stroke& stroke, double patch_m, std::size_t patches) {
  double length_m = 0;
  for (std::size_t i = 1; i < stroke.path.size(); ++i)
    length_m += (stroke.path[i].position_world_m - stroke.path[i - 1].position_world_m).norm();
  const double reach_m = stroke.radius_m + patch_m;
  const double around = reach_m * (std::numbers::pi * reach_m + 2 * length_m) / (patch_m * patch_m);
  return static_cast<double>(stroke.path.size()) * std::min(around, static_cast<double>(patches));
}

/// Why these strokes cannot be taken; empty if they can. Those before `first` are there already.
std::string why_not(const std::vector<Stroke>& strokes, std::size_t first, const SurfaceGoalSpec& goal,
                    const SurfacePatches& surface, const RayScene& rays) {
  if (strokes.size() > kMaxStrokes)
    return fmt::format("a goal may have {} strokes: begin with a bucket in place of many", kMaxStrokes);
  double visits = 0;
  for (std::size_t i = first; i < strokes.size(); ++i)
    if (strokes[i].kind == StrokeKind::brush) visits += patch_visits(strokes[i], goal.patch_m, surface.size());
  if (visits > kMaxPatchVisits)
    return "that is too much at once: give the brush a smaller radius or fewer places, or the goal a larger patch_m";
  for (std::size_t i = first; i < strokes.size(); ++i) {
    const auto& path = strokes[i].path;
    if (std::none_of(path.begin(), path.end(),
                     [&](const SurfacePlace& place) { return patch_at(surface, rays, place).has_value(); }))
      return fmt::format("stroke {} meets no surface: its places have to lie on one, with the normal to the side meant",
                         i + 1);
  }
  return {};
}

}  // namespace

PaintedGoals::PaintedGoals(SessionInForce session) : session_in_force_(std::move(session)) {}

PaintedGoals::~PaintedGoals() = default;

PaintedGoals::Goal* PaintedGoals::find(const std::string& name) {
  const auto at = std::find_if(goals_.begin(), goals_.end(), [&](const auto& goal) { return goal->spec.name == name; });
  return at == goals_.end() ? nullptr : at->get();
}

tl::unexpected<PaintingRefusal> PaintedGoals::unknown(const std::string& name) const {
  std::vector<std::string_view> names;
  for (const auto& goal : goals_) names.push_back(goal->spec.name);
  return refused_since(Why::unknown, fmt::format("the rig has no surface goal {}: {}", in_quotes(name),
                                                 mend_for_unknown(name, names, "add one: POST /api/surface-goals")));
}

void PaintedGoals::refresh() {
  asked_at_ = std::chrono::steady_clock::now();
  auto session = session_in_force_ ? session_in_force_() : nullptr;
  if (session && (!surfaces_ || surfaces_->session != session)) {
    auto before = std::move(goals_);
    goals_.clear();
    for (const SurfaceGoalSpec& spec : session->rig.surface_goals) {
      auto goal = std::make_unique<Goal>();
      goal->spec = spec;
      // Strokes that are not saved outlive a reload.
      for (const auto& one : before)
        if (one->spec.name == spec.name && one->spec.strokes_file == spec.strokes_file && !one->document.saved) {
          goal->document = one->document;
          goal->on_disk = one->on_disk;
          goal->read = true;
        }
      goals_.push_back(std::move(goal));
    }
    surfaces_ = std::make_shared<Surfaces>(std::move(session));
  }
  for (const auto& goal : goals_) read_strokes(*goal);
}

void PaintedGoals::read_strokes(Goal& goal) {
  if (goal.read && !goal.document.saved) return;  // save() sees whether the file is another
  const auto at = written_at(goal.spec.strokes_file);
  if (goal.read && at == goal.read_at) return;
  goal.read = true;
  goal.read_at = at;
  const auto strokes = strokes_of(goal.spec);
  goal.trouble = strokes ? "" : strokes.error().front().text();
  (void)set_strokes(goal, strokes.value_or(std::vector<Stroke>{}));
  goal.on_disk = goal.document.version;
  goal.document.saved = true;
}

std::vector<std::uint32_t> PaintedGoals::set_strokes(Goal& goal, const std::vector<Stroke>& strokes) {
  std::vector<std::uint32_t> changed;
  if (goal.painted) {
    Painting& painting = *goal.painted->painting;
    const auto note = [&] { changed.insert(changed.end(), painting.changed().begin(), painting.changed().end()); };
    std::size_t same = common_start(goal.document.strokes, strokes);
    const auto& before = goal.document.strokes;
    if (same < strokes.size() && same + 1 == before.size() && goes_on(before[same], strokes[same])) {
      const auto& path = strokes[same].path;
      for (std::size_t i = before[same].path.size(); i < path.size(); ++i) {
        painting.extend(path[i]);
        note();
      }
      ++same;
    }
    while (painting.strokes().size() > same) {
      (void)painting.undo();
      note();
    }
    for (std::size_t i = same; i < strokes.size(); ++i) {
      painting.add(strokes[i]);
      note();
    }
    std::sort(changed.begin(), changed.end());
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  }
  goal.document.strokes = strokes;
  goal.document.version = version_of_strokes(painting_to_json(strokes));
  goal.document.saved = goal.document.version == goal.on_disk;
  return changed;
}

std::vector<PaintedGoals::Listed> PaintedGoals::all() {
  const std::lock_guard lock(mutex_);
  refresh();
  std::vector<Listed> all;
  for (const auto& goal : goals_) all.push_back({goal->spec, goal->document, goal->in_force, goal->trouble});
  return all;
}

Painted<PaintingDocument> PaintedGoals::document(const std::string& name) {
  const std::lock_guard lock(mutex_);
  refresh();
  const Goal* goal = find(name);
  if (!goal) return unknown(name);
  if (!goal->trouble.empty()) return refused_since(Why::conflict, goal->trouble);
  return goal->document;
}

Painted<void> PaintedGoals::need_painting(Goal& goal) {
  if (!goal.trouble.empty()) return refused_since(Why::conflict, goal.trouble);
  if (!goal.unpaintable.empty()) return refused_since(Why::conflict, goal.unpaintable);
  if (goal.painted) return {};
  if (std::find(wanted_.begin(), wanted_.end(), goal.spec.name) == wanted_.end()) wanted_.push_back(goal.spec.name);
  if (!making_) {
    if (maker_.joinable()) maker_.join();  // it has nothing left to do but end
    making_ = true;
    maker_ = std::jthread([this](const std::stop_token& stop) {
      make_background();
      make_all(stop);
    });
  }
  wake_.notify_all();
  return refused_since(Why::not_yet, "the surfaces are being cut into patches: ask again in a second");
}

void PaintedGoals::make_all(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    if (wanted_.empty()) {
      (void)wake_.wait_until(lock, stop, asked_at_ + kForgotten, [&] { return !wanted_.empty(); });
      if (!wanted_.empty() || stop.stop_requested() || std::chrono::steady_clock::now() < asked_at_ + kForgotten)
        continue;
      for (const auto& goal : goals_) goal->forget();
      if (surfaces_) surfaces_ = std::make_shared<Surfaces>(surfaces_->session);
      break;
    }
    const std::string name = wanted_.front();
    Goal* goal = find(name);
    if (goal && !goal->painted) {
      const std::shared_ptr<Surfaces> surfaces = surfaces_;
      const SurfaceGoalSpec spec = goal->spec;
      const std::vector<Stroke> strokes = goal->document.strokes;
      lock.unlock();
      Result<SurfacePainter::Painted> painted = refusal("this rig has no scene to paint on");
      if (surfaces->session->rays && !surfaces->session->scene.triangles.empty())
        painted = surfaces->painter.paint(spec, strokes);
      lock.lock();
      goal = find(name);
      // What came meanwhile is worked out anew.
      if (goal && (surfaces != surfaces_ || goal->document.strokes != strokes)) continue;
      if (goal && painted) {
        goal->surfaces = surfaces;
        goal->painted.emplace(std::move(*painted));
      } else if (goal) {
        goal->unpaintable = painted.error().detail;
      }
    }
    std::erase(wanted_, name);
  }
  making_ = false;
}

Painted<PaintingChange> PaintedGoals::put(const std::string& name, const std::vector<Stroke>& strokes,
                                          const std::optional<std::string>& if_match) {
  const std::lock_guard lock(mutex_);
  refresh();
  Goal* goal = find(name);
  if (!goal) return unknown(name);
  PaintingChange change;
  const bool same = goal->document.strokes == strokes;  // sent again, since the answer was lost
  if (if_match && *if_match != goal->document.version && !same)
    return tl::unexpected(PaintingRefusal{
        Why::stale,
        fmt::format("{} has been painted by somebody else meanwhile: here are its strokes", in_quotes(name)),
        goal->document});
  if (const auto ready = need_painting(*goal); !ready) return tl::unexpected(ready.error());
  const SurfacePainter::Painted& painted = *goal->painted;
  if (auto why = why_not(strokes, common_start(goal->document.strokes, strokes), goal->spec, *painted.surface,
                         *goal->surfaces->session->rays);
      !why.empty())
    return refused_since(Why::invalid, std::move(why));
  change.patches = set_strokes(*goal, strokes);
  for (const std::uint32_t patch : change.patches) change.lux.push_back(painted.painting->lux()[patch]);
  change.version = goal->document.version;
  change.strokes = strokes.size();
  return change;
}

Painted<std::shared_ptr<const KeptAnswer>> PaintedGoals::patches(const std::string& name) {
  const std::lock_guard lock(mutex_);
  refresh();
  Goal* goal = find(name);
  if (!goal) return unknown(name);
  if (const auto ready = need_painting(*goal); !ready) return tl::unexpected(ready.error());
  if (!goal->patch_file || goal->patch_file_of != goal->document.version) {
    goal->patch_file = std::make_shared<const KeptAnswer>(
        kept_answer("application/octet-stream",
                    patch_file(*goal->painted->surface, goal->painted->painting->lux(), goal->document.version)));
    goal->patch_file_of = goal->document.version;
  }
  return goal->patch_file;
}

Painted<std::size_t> PaintedGoals::save(const std::vector<std::string>& names) {
  const std::lock_guard lock(mutex_);
  refresh();
  for (const std::string& name : names)
    if (!find(name)) return unknown(name);
  std::vector<Goal*> unsaved;
  for (const auto& goal : goals_)
    if (!goal->document.saved &&
        (names.empty() || std::find(names.begin(), names.end(), goal->spec.name) != names.end()))
      unsaved.push_back(goal.get());
  for (Goal* goal : unsaved)
    if (const auto ready = need_painting(*goal); !ready) return tl::unexpected(ready.error());
  for (Goal* goal : unsaved)
    if (const auto saved = save(*goal); !saved) return tl::unexpected(saved.error());
  return unsaved.size();
}

Painted<void> PaintedGoals::save(Goal& goal) {
  const auto in_file = strokes_of(goal.spec);
  if (!in_file) return refused_since(Why::conflict, in_file.error().front().text());
  if (auto version = version_of_strokes(painting_to_json(*in_file)); version != goal.on_disk) {
    goal.on_disk = std::move(version);
    return refused_since(Why::conflict,
                         fmt::format("another program has changed {} since it was read: save again to write over it",
                                     goal.spec.strokes_file.string()));
  }
  const std::string strokes = painting_to_json(goal.document.strokes);
  if (const auto saved =
          save_if_readable(surfaces_->session->rig.file, goal.spec, strokes, points_of(goal.spec, *goal.painted));
      !saved)
    return refused_since(saved.error().cause == Cause::invalid ? Why::conflict : Why::disk, saved.error().detail);
  goal.on_disk = goal.document.version;
  goal.document.saved = true;
  goal.read_at = written_at(goal.spec.strokes_file);
  return {};
}

Painted<void> PaintedGoals::add(const std::string& name, const std::optional<double>& max_lx) {
  const std::lock_guard lock(mutex_);
  refresh();
  if (!surfaces_) return refused_since(Why::not_yet, "the rig is not read yet: ask again in a second");
  if (find(name))
    return refused_since(Why::conflict, fmt::format("there is a surface goal {} already", in_quotes(name)));
  auto added = add_surface_goal(surfaces_->session->rig.file, name, max_lx);
  if (!added)
    return refused_since(added.error().cause == Cause::invalid ? Why::conflict : Why::disk, added.error().detail);
  auto goal = std::make_unique<Goal>();
  goal->spec = std::move(*added);
  goal->in_force = false;
  goals_.push_back(std::move(goal));
  read_strokes(*goals_.back());
  return {};
}

}  // namespace luxrig
