#pragma once
/// What the controller needs from the world: four capabilities, and how a device says how it is.
/// Drivers implement them over real buses, sim/ in process.
///
/// No call blocks longer than the bound its driver states (drivers/driver.h). All times are the
/// controller's. Failure is a value; nothing throws.

#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "core/rig/frames.h"

namespace luxrig {

/// drive: 0…1, what is sent to a fixture's dimmer after its dimmer curve was undone.
struct LevelCommand {
  std::size_t fixture = 0;  ///< index in the rig
  double drive = 0;
};

class LevelOutput {
 public:
  virtual ~LevelOutput() = default;
  /// Sets and sends. All fixtures of this device in one call, in any order. A NaN, a drive outside 0…1 or a fixture
  /// of another bus: Cause::invalid, and nothing is sent.
  virtual Result<void> write(Time now, std::span<const LevelCommand> commands) = 0;
};

struct AimCommand {
  std::size_t fixture = 0;
  PanTilt joints;
};

class Mover {
 public:
  virtual ~Mover() = default;
  /// Sets where heads shall be; sent with the next LevelOutput::write when both travel in one frame.
  virtual Result<void> move(Time now, std::span<const AimCommand> commands) = 0;
};

struct LuxReading {
  std::size_t luxmeter = 0;  ///< index in the rig
  double lux = 0;
  Time taken{};
};

class LuxReader {
 public:
  virtual ~LuxReader() = default;
  /// Whatever is new since the last call, perhaps nothing. One meter that does not answer does not hold back the
  /// others' readings; it shows in the health report. A fault when the whole bus is gone.
  virtual Result<std::vector<LuxReading>> read(Time now) = 0;
};

/// A linear-light picture; no driver makes one yet.
struct TakenPicture {
  int width = 0, height = 0;
  std::vector<float> luminance_cd_m2;  ///< row by row from the top
  Time taken{};
};

class PictureTaker {
 public:
  virtual ~PictureTaker() = default;
  virtual Result<TakenPicture> take(Time now) = 0;
};

enum class Life { configured, active, faulted };
[[nodiscard]] const char* name_of(Life life);

/// How one device (a bus, a fixture's dimmer, a meter) is.
struct Health {
  std::string device;  ///< name in the rig file
  Life life = Life::configured;
  std::string detail;  ///< empty when well; else cause and figures
  Time since{};        ///< when `life` began
  Time last_ok{};      ///< last successful exchange; Time{} = never
  std::uint64_t sent = 0, received = 0, errors = 0;
};

}  // namespace luxrig
