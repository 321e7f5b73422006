#pragma once
/// Base of all drivers: life cycle, stated bounds, health.
///
/// configured --activate()--> active <--> faulted --deactivate()--> configured
///
/// The constructor touches no device. An active driver becomes faulted, and active again, as the device goes and
/// returns. It reconnects inside write() and read(), within their bounds, with backoff. After a return it sends the
/// current setpoint, never an older one. One driver serves one [[bus]] or one [[camera]]. All its calls come from one
/// thread.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/output/devices.h"
#include "core/rig/rig.h"

namespace luxrig {

struct DriverBounds {
  Duration write{};          ///< write() and move() return within
  Duration read{};           ///< read() returns within
  Duration write_period{};   ///< how often write() should be called (DMX 1/44 s; a Modbus dimmer 100 ms)
  Duration read_period{};    ///< how often read() should be called; 0 = no reader
  Duration fault_after{};    ///< faulted at most this long after the peer is lost
  bool notices_loss = true;  ///< false: the protocol cannot notice a loss (multicast sACN)
};

/// What a DMX line carries now, for display.
struct CarriedUniverse {
  int number = 0;                   ///< as patched
  std::vector<std::uint8_t> slots;  ///< as last sent; [0] is address 1
  bool silent = false;              ///< a desk sends it instead
};

/// A switch on the bus that requests a blackout; unknown = it has not answered for some time.
enum class Contact { unknown, rests, pressed };

class Driver {
 public:
  virtual ~Driver() = default;

  [[nodiscard]] virtual DriverBounds bounds() const = 0;
  /// Opens the device. Idempotent. An absent peer is not an error: the driver starts faulted and keeps trying.
  virtual Result<void> activate(Time now) = 0;
  /// Ends the stream as the protocol asks (sACN: three terminated packets) and closes. Idempotent.
  virtual void deactivate(Time now) = 0;
  /// The bus first, then each device on it that can be told apart.
  [[nodiscard]] virtual std::vector<Health> health(Time now) const = 0;

  /// DMX drivers only.
  [[nodiscard]] virtual std::vector<CarriedUniverse> carried() const { return {}; }

  /// Empty if the bus has no such switch.
  [[nodiscard]] virtual std::optional<Contact> contact(Time) const { return std::nullopt; }

  /// Capabilities; null if the bus has none. Owned by the driver.
  virtual LevelOutput* level_output() { return nullptr; }
  virtual Mover* mover() { return nullptr; }
  virtual LuxReader* lux_reader() { return nullptr; }
  virtual LevelInput* level_input() { return nullptr; }
  virtual PictureTaker* picture_taker() { return nullptr; }
};

}  // namespace luxrig
