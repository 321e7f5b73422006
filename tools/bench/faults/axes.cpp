// Axes on a CAN bus: the true motion of the simulated joints during a fault. In simulated time, without sockets.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "drivers/can/canopen_driver.h"
#include "tools/bench/buses/axes_wire.h"
#include "tools/bench/faults/fault_cases.h"
#include "tools/bench/row_progress.h"

namespace luxrig {
namespace {

using sim::FaultKind;

constexpr const char* kAxesBus = "the-bus";
constexpr double kArrived_deg = 0.05, kOffPath_deg = 0.5;
constexpr double kStray_deg = 0.5;          // above a set-point's rounding and a drive's following error
constexpr double kAxesRecoverWithin_s = 5;  // without the homing after a lost position
constexpr double kHoming_s = 60, kAxesGiveUp_s = 120;
constexpr Duration kAxesWellFor = std::chrono::milliseconds(500);

/// Nodes 5 and 6, ±170° and ±120°, 90 and 60 °/s, 180 and 120 °/s², home at a limit switch.
Rig head_on_axes() {
  Rig rig;
  rig.file = rig.name = "bench";
  Bus axes, lamps;
  axes.name = kAxesBus;
  axes.driver = "canopen";
  axes.options["interface"] = {std::string("can0"), {}};
  lamps.name = "lamps";
  lamps.driver = "sacn";
  rig.buses = {axes, lamps};
  Fixture head;
  head.name = "head";
  head.bus = 1;
  head.patch = DmxPatch{1, 1, {DmxSlot{}}};
  head.moves = true;
  head.range = {rad_from_deg(-170), rad_from_deg(170), rad_from_deg(-120), rad_from_deg(120)};
  head.pan_speed_rad_s = rad_from_deg(90);
  head.tilt_speed_rad_s = rad_from_deg(60);
  head.axes =
      AxesPatch{0, {5, 500, rad_from_deg(-175), rad_from_deg(180)}, {6, -400, rad_from_deg(125), rad_from_deg(120)}};
  rig.fixtures.push_back(head);
  return rig;
}

class AxisCases {
 public:
  AxisCases(const FaultPlan& plan, std::uint64_t seed)
      : plan_(plan), rig_(head_on_axes()), faults_(seed), random_(seed) {
    auto world = sim::World::make(rig_, sim::Deviations::none(), Eigen::MatrixXd::Zero(0, 1));
    if (!world) return;
    world_ = std::move(*world);
    axes_ = std::make_unique<sim::AxisBus>(sim::EndpointParts{rig_, 0, *world_, faults_});
    driver_ = make_canopen(rig_, 0, std::make_unique<AxesWire>(*axes_, now_, interface_down_));
    if (!driver_->activate(now_)) driver_.reset();
  }
  [[nodiscard]] bool ok() const { return driver_ != nullptr; }

  FaultOutcome run() {
    const auto between = [&](double least, double most) {
      return std::uniform_real_distribution<double>(least, most)(random_);
    };
    began_.reset();
    wait_until_well();
    order(between(-160, 160), between(-110, 110));
    outcome_ = {};
    lost_position_ = came_to_rest_ = asked_again_ = false;
    for (const Time phase = now_ + from_seconds(between(0, 2.5)); now_ < phase;) cycle();
    began_ = now_;
    switch_fault(true, between(plan_.value_least, plan_.value_most));
    const Time over = now_ + from_seconds(between(plan_.shortest_s, plan_.longest_s));
    // In half of the cases a new aim is asked during the fault.
    const bool again = between(0, 1) < 0.5;
    const Time asked_at = now_ + from_seconds(between(0, to_seconds(over - now_)));
    while (now_ < over) {
      const Time before = now_;
      cycle();
      if (!again || before >= asked_at || now_ < asked_at) continue;
      asked_again_ = true;
      order(between(-160, 160), between(-110, 110));
    }
    switch_fault(false, 0);
    const Time ended = now_;
    cycle();
    if (wait_until_well()) outcome_.recovered_s = std::max(0.0, to_seconds(*well_since_ - ended));
    const FaultOutcome outcome = outcome_;
    for (const Time rested = now_ + from_seconds(plan_.rest_s); now_ < rested;) cycle();
    return outcome;
  }

 private:
  struct Span {
    double least = 0, most = 0;
    void take(double value) {
      least = std::min(least, value);
      most = std::max(most, value);
    }
    [[nodiscard]] double beyond(double value) const { return std::max({least - value, value - most, 0.0}); }
  };

  void switch_fault(bool on, double value) {
    if (plan_.kind == FaultKind::dead && plan_.device == kAxesBus) {
      interface_down_ = on;  // the adapter is pulled out
    } else if (on) {
      faults_.set(plan_.device, plan_.kind, true, value);
    } else {
      faults_.clear();
    }
  }

  /// A new aim: from now on the joints may be anywhere between their present place and the aim.
  void order(double pan_deg, double tilt_deg) {
    const Joints stand = joints();
    from_ = stand;
    aim_ = Joints{rad_from_deg(pan_deg), rad_from_deg(tilt_deg)};
    well_since_.reset();
    if (!began_) pan_ = {deg_from_rad(stand.pan_rad), deg_from_rad(stand.pan_rad)};
    if (!began_) tilt_ = {deg_from_rad(stand.tilt_rad), deg_from_rad(stand.tilt_rad)};
    pan_.take(deg_from_rad(stand.pan_rad));
    tilt_.take(deg_from_rad(stand.tilt_rad));
    pan_.take(pan_deg);
    tilt_.take(tilt_deg);
    run_out();
  }

  /// A moving axis cannot stop at once. After a new aim behind it, it may run on as far as its deceleration requires.
  void run_out() {
    const auto stop_deg = [](const sim::AxisDrive& drive, double max_deg_s2) {
      const double speed = drive.speed_deg_s();
      return speed * std::abs(speed) / (2 * max_deg_s2) + 0.05 * speed;  // and the handshake
    };
    pan_.take(deg_from_rad(joints().pan_rad) + stop_deg(pan_drive(), 180));
    tilt_.take(deg_from_rad(joints().tilt_rad) + stop_deg(tilt_drive(), 120));
  }

  bool wait_until_well() {
    const Time until = now_ + from_seconds(kAxesGiveUp_s);
    const auto well = [&] { return well_since_ && now_ - *well_since_ >= kAxesWellFor; };
    while (now_ < until && !well()) cycle();
    return well();
  }

  void cycle() {
    now_ += driver_->bounds().write_period;
    while (world_->now() + sim::kTick <= now_) {
      axes_->advance(world_->now() + sim::kTick);
      world_->advance(world_->now() + sim::kTick);
      look();
    }
    const AimCommand command{0, aim_};
    (void)driver_->mover()->move(now_, {&command, 1});
    const std::vector<Health> all = driver_->health(now_);
    const bool active = std::all_of(all.begin(), all.end(), [](const Health& h) { return h.life == Life::active; });
    if (!active && began_ && !outcome_.reported_s) outcome_.reported_s = to_seconds(now_ - *began_);
    const Joints at = joints();
    const bool there = deg_from_rad(std::max(std::abs(at.pan_rad - aim_.pan_rad),
                                             std::abs(at.tilt_rad - aim_.tilt_rad))) < kArrived_deg;
    if (!active || !there) {
      well_since_.reset();
    } else if (!well_since_) {
      well_since_ = now_;
    }
  }

  /// Compares the truth with the aim.
  void look() {
    if (!began_) return;
    const Joints at = joints();
    const double pan_deg = deg_from_rad(at.pan_rad), tilt_deg = deg_from_rad(at.tilt_rad);
    if (!pan_drive().homed() || !tilt_drive().homed()) lost_position_ = true;
    if (lost_position_ && std::abs(pan_drive().speed_deg_s()) < 0.01 && std::abs(tilt_drive().speed_deg_s()) < 0.01) {
      came_to_rest_ = true;  // later motion is homing, by its own rule
    }
    if (lost_position_ && !plan_.loses_position) came_to_rest_ = true;  // taken for restarted: same rule
    if (came_to_rest_) {
      check_travel(pan_deg, tilt_deg);
      return;
    }
    const double off = off_path_deg(pan_deg, tilt_deg), beyond = excess(pan_deg, tilt_deg);
    // The way from an aim in progress to another is no straight line.
    if (!asked_again_) outcome_.departure = std::max(outcome_.departure, off);
    if (!asked_again_ && off > kOffPath_deg) outcome_.departed_s += to_seconds(sim::kTick);
    outcome_.excess = std::max(outcome_.excess, beyond);
    // Without power an axis runs on by its momentum: that cannot be prevented.
    if (beyond > kStray_deg && !lost_position_ && outcome_.astray.empty()) {
      outcome_.astray =
          fmt::format("at {:.1f} and {:.1f} deg: {:.1f} beyond what was asked; {:.2f} s after the beginning", pan_deg,
                      tilt_deg, beyond, to_seconds(world_->now() - *began_));
    }
  }

  void check_travel(double pan_deg, double tilt_deg) {
    // The home switch is 5 degrees past the travel.
    if (std::abs(pan_deg) < 178 && std::abs(tilt_deg) < 128) return;
    if (outcome_.astray.empty()) outcome_.astray = fmt::format("at {:.1f} and {:.1f} deg", pan_deg, tilt_deg);
  }

  [[nodiscard]] double excess(double pan_deg, double tilt_deg) const {
    return std::max(pan_.beyond(pan_deg), tilt_.beyond(tilt_deg));
  }
  /// Distance from the straight line between the place where the aim was asked and the aim.
  [[nodiscard]] double off_path_deg(double pan_deg, double tilt_deg) const {
    const double x = deg_from_rad(from_.pan_rad), y = deg_from_rad(from_.tilt_rad);
    const double dx = deg_from_rad(aim_.pan_rad) - x, dy = deg_from_rad(aim_.tilt_rad) - y;
    const double way = dx * dx + dy * dy;
    const double share = way > 0 ? std::clamp(((pan_deg - x) * dx + (tilt_deg - y) * dy) / way, 0.0, 1.0) : 0;
    return std::hypot(pan_deg - x - share * dx, tilt_deg - y - share * dy);
  }

  [[nodiscard]] Joints joints() const { return world_->joints()[0]; }
  [[nodiscard]] const sim::AxisDrive& pan_drive() const { return axes_->pan(0).drive(); }
  [[nodiscard]] const sim::AxisDrive& tilt_drive() const { return axes_->tilt(0).drive(); }

  FaultPlan plan_;
  Rig rig_;
  sim::Faults faults_;
  std::mt19937_64 random_;
  std::unique_ptr<sim::World> world_;
  std::unique_ptr<sim::AxisBus> axes_;
  Time now_{};
  bool interface_down_ = false, lost_position_ = false, came_to_rest_ = false, asked_again_ = false;
  std::unique_ptr<Driver> driver_;
  Joints aim_{}, from_{};
  Span pan_, tilt_;  ///< allowed range of the joints [deg]
  std::optional<Time> began_, well_since_;
  FaultOutcome outcome_;
};

std::vector<FaultPlan> axis_plans() {
  const std::string bus = kAxesBus, pan = "head (pan axis)";
  const auto plan = [](FaultKind kind, const std::string& device, double least, double most, const char* suffix,
                       const char* note = "") {
    FaultPlan made{kind, device, least, most};
    made.suffix = suffix;
    made.note = note;
    return made;
  };
  std::vector<FaultPlan> plans = {
      plan(FaultKind::lost, bus, 0.05, 0.5, "", "of many lost frames some look like a restart: homed anew"),
      plan(FaultKind::slow, bus, 10, 200, "", "a frame with a wrong CRC is sent again by the controllers: late"),
      plan(FaultKind::duplicated, bus, 0.2, 1, ""),
      plan(FaultKind::silent, bus, 1, 1, "", "cable broken"),
      plan(FaultKind::dead, bus, 1, 1, "", "adapter unplugged"),
      plan(FaultKind::bus_off, bus, 1, 1, ""),
      plan(FaultKind::garbled, pan, 1, 1, "-axis",
           "a node that says wrong things: may be taken for restarted and homed; 31 s between cases"),
      plan(FaultKind::silent, pan, 1, 1, "-axis", "its cable"),
      plan(FaultKind::stuck, pan, 1, 1, "-axis", "blocked; 31 s between cases: 4 faults in a row are a person's"),
      plan(FaultKind::reset, pan, 1, 1, "-axis", "position lost: homed anew"),
      plan(FaultKind::dead, pan, 1, 1, "-axis", "power loss in motion: turns on by momentum; homed anew"),
  };
  for (FaultPlan& each : plans) {
    each.loses_position = each.kind == FaultKind::reset || (each.kind == FaultKind::dead && each.device == pan);
    each.homes = each.loses_position || each.kind == FaultKind::garbled || each.kind == FaultKind::lost;
    if (each.kind == FaultKind::stuck || each.kind == FaultKind::garbled) each.rest_s = 31;
  }
  return plans;
}

}  // namespace

void add_axis_faults(const BenchOptions& options, std::vector<BenchRow>& rows) {
  std::uint64_t seed = 2000;
  for (const FaultPlan& plan : axis_plans()) {
    ++seed;
    if (!fault_wanted(options, "canopen", plan)) continue;
    AxisCases cases(plan, seed);
    std::vector<FaultOutcome> outcomes;
    for (int i = 0; i < fault_count(options) && cases.ok(); ++i) outcomes.push_back(cases.run());
    const double bound_s = kAxesRecoverWithin_s + (plan.homes ? kHoming_s : 0);
    rows.push_back(row_of_faults("canopen", plan, "deg", outcomes, bound_s));
    say_row_made(rows.back());
  }
}

}  // namespace luxrig
