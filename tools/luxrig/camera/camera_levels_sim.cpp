// The series with a simulated rig: driven by the rig's own protocol, seen by its own camera.
#include <fmt/format.h>

#include <chrono>
#include <future>
#include <thread>

#include "core/output/dimming.h"
#include "core/output/output_program.h"
#include "core/picture/pfm.h"
#include "tools/http/client.h"
#include "tools/luxrig/camera/camera_levels.h"
#include "tools/process/clock.h"
#include "tools/process/sim_process.h"

namespace luxrig {
namespace {

constexpr int kPictureWait_s = 180;
constexpr std::chrono::milliseconds kStep(23);
constexpr std::chrono::seconds kLampsSettle(1);  ///< simulated lamps follow with a lag of 0.05 s

/// Drives the fixture's bus as the daemon does.
class SimulatedLight final : public LevelLight {
 public:
  SimulatedLight(const Rig& rig, std::size_t fixture, std::unique_ptr<Driver> driver)
      : rig_(rig), fixture_(fixture), driver_(std::move(driver)) {}
  ~SimulatedLight() override { driver_->deactivate(now()); }

  Result<double> set(double level) override {
    drive_ = drive_for(rig_.fixtures[fixture_], level);
    Result<void> written;
    for (const Time until = now() + kLampsSettle; now() < until;) {
      written = write();
      std::this_thread::sleep_for(driver_->bounds().write_period);
    }
    if (!written) return tl::unexpected(written.error());
    return level;
  }
  Result<void> still() override { return write(); }
  void give_back() override {}

 private:
  Result<void> write() {
    std::vector<LevelCommand> commands;
    for (std::size_t f = 0; f < rig_.fixtures.size(); ++f)
      if (rig_.fixtures[f].bus == rig_.fixtures[fixture_].bus) commands.push_back({f, f == fixture_ ? drive_ : 0.0});
    return driver_->level_output()->write(now(), commands);
  }

  const Rig& rig_;
  std::size_t fixture_;
  std::unique_ptr<Driver> driver_;
  double drive_ = 0;
};

std::string in_query(const std::string& text) {
  std::string out;
  for (const unsigned char c : text)
    out += std::isalnum(c) != 0 ? std::string(1, static_cast<char>(c)) : fmt::format("%{:02X}", c);
  return out;
}

Result<RawPicture> picture_of_sim(const Redirect& control, const PictureCamera& camera) {
  const auto answer =
      http_get({control.host, control.port}, "/picture?camera=" + in_query(camera.name), kPictureWait_s);
  if (!answer || answer->status != 200)
    return tl::unexpected(Fault{Cause::network, camera.name, "the simulated rig gives no picture", {}});
  const auto picture = picture_from_pfm(answer->body);
  if (!picture) return tl::unexpected(picture.error());
  RawPicture raw;
  raw.width_px = picture->width_px;
  raw.height_px = picture->height_px;
  raw.channels = 3;
  raw.full_scale_counts = 4095;
  raw.is_light = true;
  raw.samples.reserve(3 * picture->luminance_cd_m2.size());
  for (const Vec3f& pixel : picture->luminance_cd_m2) raw.samples.insert(raw.samples.end(), pixel.begin(), pixel.end());
  return raw;
}

}  // namespace

Result<LevelSeries> simulated_level_series(const Rig& rig, const std::filesystem::path& rig_path, std::size_t camera,
                                           std::uint64_t seed, const LevelsWanted& wanted, const Progress& progress) {
  auto sim = SimProcess::start(rig_path, seed);
  if (!sim) return tl::unexpected(sim.error());
  const auto ports = sim->wait_ready({});
  if (!ports) return tl::unexpected(ports.error());
  const Bus& bus = rig.buses[rig.fixtures[wanted.fixture].bus];
  const auto at = ports->buses.find(bus.name);
  if (at == ports->buses.end())
    return tl::unexpected(Fault{Cause::refused, bus.name, "the simulated rig has no such bus", {}});
  auto driver = find_driver(bus.driver)->make(rig, rig.fixtures[wanted.fixture].bus, at->second);
  if (auto active = driver->activate(now()); !active) return tl::unexpected(active.error());
  SimulatedLight light(rig, wanted.fixture, std::move(driver));
  const auto picture = [&] {
    // A picture takes seconds. A driver that is not stepped in that time would take its devices for lost.
    auto taken = std::async(std::launch::async, [&] { return picture_of_sim(ports->control, rig.cameras[camera]); });
    while (taken.wait_for(kStep) != std::future_status::ready) (void)light.still();
    return taken.get();
  };
  return take_level_series(light, picture, SampleCurve::linear(), wanted, progress);
}

}  // namespace luxrig
