#include "core/show/meter_readings.h"

namespace luxrig {

bool MeterReadings::hear(Time now, const LuxReading& reading, bool lost) {
  if (!samples_.add(now, reading)) return false;
  heard_[reading.luxmeter] = reading;
  if (!lost) believed_[reading.luxmeter] = reading;
  return true;
}

void MeterReadings::take(Time now, std::span<const LuxReading> sample) {
  for (const LuxReading& reading : sample) {
    changed_[reading.luxmeter] = sampled_lx_[reading.luxmeter] != reading.lux;
    sampled_lx_[reading.luxmeter] = reading.lux;
  }
  samples_.next();
  sampled_at_ = now;
}

void MeterReadings::forget(std::size_t luxmeter) {
  heard_[luxmeter].reset();
  believed_[luxmeter].reset();
  measured_[luxmeter].reset();
}

}  // namespace luxrig
