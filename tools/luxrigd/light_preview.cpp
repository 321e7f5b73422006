#include "tools/luxrigd/light_preview.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/output/keep_out.h"
#include "core/rig/housing.h"
#include "core/tasks/rig_transport.h"
#include "tools/luxrigd/by_hand_names.h"
#include "tools/luxrigd/scheduling.h"

namespace luxrig {
namespace {

constexpr double kNearestAim_m = 0.01;

Result<PreviewedLight> superseded() {
  return tl::unexpected(Fault{Cause::cancelled, {}, "a newer question of yours has taken its place", {}});
}

std::string range_text(const char* joint, double wanted_rad, double least_rad, double most_rad) {
  if (wanted_rad >= least_rad && wanted_rad <= most_rad) return "";
  return fmt::format("{} {:.0f}° is needed, and it goes from {:.0f}° to {:.0f}°", joint, deg_from_rad(wanted_rad),
                     deg_from_rad(least_rad), deg_from_rad(most_rad));
}

/// Why a head does not get there; empty if it does.
std::string out_of_range(const JointRange& range, const Joints& wanted) {
  std::string why = range_text("pan", wanted.pan_rad, range.pan_min_rad, range.pan_max_rad);
  const std::string tilt = range_text("tilt", wanted.tilt_rad, range.tilt_min_rad, range.tilt_max_rad);
  if (!why.empty() && !tilt.empty()) why += "; ";
  return why + tilt;
}

/// Turns one fixture as wanted; what is not reached leaves it as it is.
void turn(const Fixture& fixture, const WantedChange& wanted, PreviewedFixture& out) {
  Joints to = out.joints;
  JointRange free;
  free.pan_min_rad = free.tilt_min_rad = -kPi;
  free.pan_max_rad = free.tilt_max_rad = kPi;
  if (wanted.aim_world_m) {
    const Vec3 towards = *wanted.aim_world_m - fixture.world_from_mount.translation_m;
    if (towards.norm() < kNearestAim_m) {
      out.reached = false;
      out.why = "that point is in the lamp itself";
      return;
    }
    const auto found =
        fixture.moves ? pan_tilt_towards(fixture.world_from_mount, towards, fixture.range, out.joints) : std::nullopt;
    to = found ? *found : pan_tilt_towards(fixture.world_from_mount, towards, free, out.joints).value_or(to);
  } else if (wanted.joints) {
    to.pan_rad = wanted.joints->pan_rad;
    to.tilt_rad = wanted.joints->tilt_rad;
  } else {
    return;
  }
  out.by_a_person = !fixture.moves;
  if (fixture.moves) out.why = out_of_range(fixture.range, to);
  out.reached = out.why.empty();
  if (out.reached) out.joints = to;
}

}  // namespace

struct LightPreview::Reflections {
  std::shared_ptr<const Session> session;
  std::vector<Receiver> receivers;
  std::mutex mutex;  // guards the two below
  std::shared_ptr<const IncrementalTransport> ready;
  std::string failed;
  std::jthread making;  ///< last: it uses the members above
};

LightPreview::LightPreview() = default;
LightPreview::~LightPreview() = default;

bool LightPreview::is_newest(std::uint64_t question) {
  const std::lock_guard lock(mutex_);
  return question == questions_;
}

Result<PreviewedLight> LightPreview::light(const std::shared_ptr<const Session>& session, const ShowStatus& show,
                                           const std::vector<WantedChange>& wanted, bool reflections,
                                           const std::string& client) {
  std::uint64_t question = 0;
  {
    std::unique_lock lock(mutex_);
    if (busy_ && client_ != client)
      return tl::unexpected(Fault{Cause::timeout, {}, "another client's is being computed: ask again", {}});
    client_ = client;
    question = ++questions_;
    changed_.notify_all();  // one that waits is old now
    changed_.wait(lock, [&] { return !busy_ || question != questions_; });
    if (question != questions_) return superseded();
    busy_ = true;
  }
  auto light = compute(session, show, wanted, reflections, question);
  const std::lock_guard lock(mutex_);
  busy_ = false;
  changed_.notify_all();
  return light;
}

std::shared_ptr<const IncrementalTransport> LightPreview::reflections_of(const std::shared_ptr<const Session>& session,
                                                                         std::string& why_not) {
  if (!reflections_ || reflections_->session != session) {
    reflections_ = std::make_unique<Reflections>();  // ends the one before
    reflections_->session = session;
    reflections_->receivers = receivers_of(session->rig);
    reflections_->receivers.resize(session->rig.points.size());
    reflections_->making = std::jthread([to = reflections_.get()](const std::stop_token& stop) {
      make_background();
      IncrementalOptions options;
      options.watch.stop = stop;
      auto made = IncrementalTransport::make(to->session->scene, *to->session->rays, to->receivers, options);
      const std::lock_guard lock(to->mutex);
      if (made)
        to->ready = std::move(*made);
      else
        to->failed = made.error().detail;
    });
  }
  const std::lock_guard lock(reflections_->mutex);
  if (!reflections_->ready)
    why_not = reflections_->failed.empty() ? "reflected light is being made ready: it is taken as it is now"
                                           : "reflected light is taken as it is now: " + reflections_->failed;
  return reflections_->ready;
}

Result<LightPreview::Column> LightPreview::column(const Session& session, std::size_t fixture, const Joints& joints,
                                                  const IncrementalTransport* reflected) const {
  const Fixture& one = session.rig.fixtures[fixture];
  Emitter emitter = emitter_of(session.rig.luminaires[one.luminaire], one.world_from_lamp(joints), joints.beam_rad);
  std::vector<Receiver> receivers = receivers_of(session.rig);
  receivers.resize(session.rig.points.size());
  const auto direct = make_direct_evaluator(*session.rays)->evaluate(receivers, {&emitter, 1}, {});
  if (!direct) return tl::unexpected(direct.error());
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(receivers.size()));
  Column out{joints, false, direct->lux_per_level.col(0), none, none};
  if (reflected == nullptr) return out;
  emitter.shape = {};
  auto all = reflected->column(emitter);
  if (!all) return tl::unexpected(all.error());
  out.reflected_lux = all->total_lux - all->direct_lux;
  out.standard_error_lux = std::move(all->standard_error_lux);
  out.has_reflected = true;
  return out;
}

Result<LightPreview::Column> LightPreview::column_now(const Session& session, std::size_t fixture, const Joints& joints,
                                                      const IncrementalTransport* reflected) {
  const auto known = now_.find(fixture);
  if (known != now_.end() && same_aim(known->second.joints, joints) &&
      (known->second.has_reflected || reflected == nullptr))
    return known->second;
  auto made = column(session, fixture, joints, reflected);
  if (made) now_[fixture] = *made;
  return made;
}

Result<PreviewedLight> LightPreview::compute(const std::shared_ptr<const Session>& session, const ShowStatus& show,
                                             const std::vector<WantedChange>& wanted, bool reflections,
                                             std::uint64_t question) {
  const Rig& rig = session->rig;
  if (session_ != session) {
    session_ = session;
    now_.clear();
  }
  PreviewedLight out;
  const KeepOutZones zones(rig);
  for (const WantedChange& change : wanted) {
    const auto called = fixtures_called(rig, {change.fixture});
    if (!called) return tl::unexpected(called.error());
    std::vector<std::size_t> fixtures;
    for (const ByHand& one : *called) {
      const bool whole = one.whole_housing || change.aim_world_m || change.joints;
      for (const std::size_t f : whole ? housing_of(rig, one.index) : std::vector{one.index}) fixtures.push_back(f);
    }
    std::sort(fixtures.begin(), fixtures.end());
    fixtures.erase(std::unique(fixtures.begin(), fixtures.end()), fixtures.end());
    for (const std::size_t f : fixtures) {
      const Fixture& fixture = rig.fixtures[f];
      if (std::any_of(out.fixtures.begin(), out.fixtures.end(), [f](const auto& one) { return one.fixture == f; }))
        return refusal(fmt::format("\"{}\" is named twice", fixture.name));
      if (change.joints && !fixture.moves) return refusal(fmt::format("\"{}\" has no pan and tilt", fixture.name));
      PreviewedFixture one;
      one.fixture = f;
      one.joints = show.fixtures[f].joints;
      one.level = show.fixtures[f].level;
      turn(fixture, change, one);
      if (const auto zone = zones.met(f, one.joints); zone && one.reached && (change.aim_world_m || change.joints)) {
        one.reached = false;
        one.why = fmt::format("it would look into keep-out zone \"{}\"", zones.name(*zone));
        one.joints = show.fixtures[f].joints;
      }
      if (change.level) {
        one.level = std::min(*change.level, rig.max_level(fixture));
        if (one.level < *change.level)
          one.why += fmt::format("{}its most is {:.0f} %", one.why.empty() ? "" : "; ", 100 * one.level);
      }
      out.fixtures.push_back(std::move(one));
    }
  }
  std::shared_ptr<const IncrementalTransport> reflected;
  if (reflections) reflected = reflections_of(session, out.text);
  out.reflections = reflected != nullptr;

  const auto points = static_cast<Eigen::Index>(rig.points.size());
  Eigen::VectorXd lux(points), variance(points);
  for (Eigen::Index p = 0; p < points; ++p) {
    lux[p] = show.points[static_cast<std::size_t>(p)].predicted_lx;
    variance[p] = std::pow(show.points[static_cast<std::size_t>(p)].standard_error_lx, 2);
  }
  for (const PreviewedFixture& one : out.fixtures) {
    const FixtureStatus& is = show.fixtures[one.fixture];
    if (one.level == is.level && same_aim(one.joints, is.joints)) continue;
    if (!is_newest(question)) return superseded();
    const auto before = column_now(*session, one.fixture, is.joints, reflected.get());
    if (!before) return tl::unexpected(before.error());
    if (!is_newest(question)) return superseded();
    const bool stays = same_aim(one.joints, is.joints);
    const auto after = stays ? before : column(*session, one.fixture, one.joints, reflected.get());
    if (!after) return tl::unexpected(after.error());
    Eigen::VectorXd change = one.level * after->direct_lux - is.level * before->direct_lux;
    if (reflected) {
      change += one.level * after->reflected_lux - is.level * before->reflected_lux;
      const double share = is.gain * is.gain;
      if (stays)
        variance += share * (std::abs(one.level - is.level) * after->standard_error_lux).cwiseAbs2();
      else
        variance += share * ((one.level * after->standard_error_lux).cwiseAbs2() +
                             (is.level * before->standard_error_lux).cwiseAbs2());
    }
    lux += is.gain * change;
    variance += (is.gain_standard_error * change).cwiseAbs2();
  }
  lux = lux.cwiseMax(0.0);
  out.lux.assign(lux.begin(), lux.end());
  if (!reflected) return out;
  const Eigen::VectorXd error = variance.cwiseSqrt();
  out.standard_error_lux.assign(error.begin(), error.end());
  return out;
}

}  // namespace luxrig
