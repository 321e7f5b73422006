#pragma once
/// The canopen driver and simulated axes on one wire without sockets, under one stepped clock: exact and fast.

#include <deque>
#include <functional>
#include <memory>
#include <stdexcept>
#include <vector>

#include "drivers/can/canopen_driver.h"
#include "sim/wire/can/axis_bus.h"
#include "tests/drivers/test_rig.h"

namespace luxrig {

/// One head on nodes 5 and 6, ±170° and ±120°, 90 and 60 °/s, 180 and 120 °/s², home at a limit switch.
inline Rig rig_of_axes(std::vector<std::pair<std::string, OptionValue>> options = {}) {
  options.push_back({"interface", std::string("can0")});
  Rig rig = rig_with(bus_of("canopen", std::move(options)));
  rig.buses.push_back(bus_of("sacn"));
  rig.buses[1].name = "lamps";
  Fixture& head = add_axes(add_dmx(rig, "head", 1, 1), 5, 6);
  head.bus = 1;
  head.range = {rad_from_deg(-170), rad_from_deg(170), rad_from_deg(-120), rad_from_deg(120)};
  head.pan_speed_rad_s = rad_from_deg(90);
  head.tilt_speed_rad_s = rad_from_deg(60);
  head.axes->pan = {5, 500, rad_from_deg(-175), rad_from_deg(180)};
  head.axes->tilt = {6, -400, rad_from_deg(125), rad_from_deg(120)};
  return rig;
}

class AxesBench {
 public:
  explicit AxesBench(Rig the_rig = rig_of_axes()) : rig(std::move(the_rig)) {
    const auto columns = static_cast<Eigen::Index>(rig.fixtures.size());
    auto made = sim::World::make(rig, sim::Deviations::none(), Eigen::MatrixXd::Zero(0, columns));
    if (!made) throw std::runtime_error(made.error().detail);
    world = std::move(*made);
    axes = std::make_unique<sim::AxisBus>(sim::EndpointParts{rig, 0, *world, faults});
    auto wire = std::make_unique<Wire>(*this);
    driver = make_canopen(rig, 0, std::move(wire));
    if (!driver->activate(now)) throw std::runtime_error("not activated");
  }

  /// One cycle of the control loop, with the commands that the daemon sends.
  void cycle() {
    now += driver->bounds().write_period;
    run_world(now);
    std::vector<AimCommand> commands;
    if (aim) commands.push_back({0, *aim});
    result = driver->mover()->move(now, commands);
    if (each_cycle) each_cycle();
  }
  /// Steps the far end only; no driver runs.
  void run_world(Time until) {
    while (world->now() + sim::kTick <= until) {
      axes->advance(world->now() + sim::kTick);
      world->advance(world->now() + sim::kTick);
      const Joints at = joints();
      if (turned_deg(at, last_) > 1e-6) moved_at = world->now();
      last_ = at;
      path.push_back(at);
    }
  }
  void run(double seconds) {
    for (const Time end = now + from_seconds(seconds); now < end;) cycle();
  }
  /// Runs until so() is true or the seconds are over.
  bool run_until(double seconds, const std::function<bool()>& so) {
    for (const Time end = now + from_seconds(seconds); now < end;) {
      cycle();
      if (so()) return true;
    }
    return so();
  }
  /// Runs until the head is homed and points at `aim`.
  bool arrive(double seconds = 60) {
    return run_until(seconds, [this] { return result && aim && turned_deg(joints(), *aim) < 0.05; });
  }

  [[nodiscard]] Joints joints() const { return world->joints()[0]; }
  [[nodiscard]] const sim::AxisDrive& pan() const { return axes->pan(0).drive(); }
  [[nodiscard]] const sim::AxisDrive& tilt() const { return axes->tilt(0).drive(); }
  [[nodiscard]] Health health(std::size_t i) const { return driver->health(now).at(i); }  ///< bus, pan, tilt
  static double turned_deg(const Joints& a, const Joints& b) {
    return deg_from_rad(std::max(std::abs(a.pan_rad - b.pan_rad), std::abs(a.tilt_rad - b.tilt_rad)));
  }
  static Joints deg(double pan, double tilt) { return {rad_from_deg(pan), rad_from_deg(tilt)}; }

  Rig rig;
  sim::Faults faults;
  std::unique_ptr<sim::World> world;
  std::unique_ptr<sim::AxisBus> axes;
  std::unique_ptr<Driver> driver;
  Time now{};
  std::optional<Joints> aim;
  Result<void> result;
  Time moved_at{};                  ///< time of the beam's last movement
  std::vector<Joints> path;         ///< every 10 ms
  std::vector<can::CanFrame> sent;  ///< by the driver
  std::function<void()> each_cycle;
  std::function<void(can::CanFrame&)> lie;  ///< changes the frames of a node
  can::Sent taken = can::Sent::yes;         ///< the wire's answer to a frame
  std::optional<Fault> broken;              ///< the interface is down
  int opened = 0;

 private:
  class Wire final : public can::CanChannel {
   public:
    explicit Wire(AxesBench& bench) : bench_(bench) {}
    Result<void> open() override {
      if (bench_.broken) return tl::unexpected(*bench_.broken);
      ++bench_.opened;
      open_ = true;
      return {};
    }
    void close() override { open_ = false; }
    bool is_open() const override { return open_; }
    Result<can::Sent> send(const can::CanFrame& frame) override {
      if (bench_.broken) {
        open_ = false;
        return tl::unexpected(*bench_.broken);
      }
      bench_.sent.push_back(frame);
      if (bench_.taken == can::Sent::yes) bench_.axes->receive(bench_.now, sim::bus_frame(frame.id, frame.payload()));
      return bench_.taken;
    }
    std::optional<can::CanFrame> receive() override {
      for (const sim::BusFrame& frame : bench_.axes->take_sent()) arrived_.push_back(frame);
      if (!open_) arrived_.clear();
      if (arrived_.empty()) return std::nullopt;
      auto frame = can::from_bytes(sim::packed(arrived_.front()));
      arrived_.pop_front();
      if (frame && bench_.lie) bench_.lie(*frame);
      return frame;
    }
    std::optional<Fault> take_error() override { return std::nullopt; }

   private:
    AxesBench& bench_;
    bool open_ = false;
    std::deque<sim::BusFrame> arrived_;
  };

  Joints last_{};
};

}  // namespace luxrig
