#include "core/estimation/meter_samples.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace luxrig {
namespace {

constexpr double kAgree = 0.03;    // ten times the noise of a good meter
constexpr double kSettled = 0.01;  // a lamp of 1 s then still has about one window's change to go
constexpr Duration kFlickers = std::chrono::seconds(2), kSettlesWithin = std::chrono::seconds(10);

}  // namespace

MeterSamples::MeterSamples(std::size_t luxmeters) : meters_(luxmeters) {}

bool MeterSamples::add(Time now, const LuxReading& reading) {
  if (reading.luxmeter >= meters_.size() || !std::isfinite(reading.lux) || reading.lux < 0 || reading.taken > now) {
    return false;
  }
  Meter& meter = meters_[reading.luxmeter];
  if (meter.last && reading.taken <= meter.last->taken) return false;
  meter.last = reading;
  if (reading.taken < settled_) return true;
  if (meter.window.size() == kReadings) meter.window.erase(meter.window.begin());
  meter.window.push_back(reading);
  if (meter.window.size() == kReadings && meter.full_since == Time{}) meter.full_since = now;
  return true;
}

void MeterSamples::restart(Time settled) {
  settled_ = settled;
  next();
}

void MeterSamples::next() {
  for (Meter& meter : meters_) {
    meter.window.clear();
    meter.full_since = Time{};
  }
}

bool MeterSamples::ready(Time now, std::size_t luxmeter) const {
  const Meter& meter = meters_[luxmeter];
  if (meter.window.size() < kReadings) return false;
  const auto [least, most] = std::minmax_element(meter.window.begin(), meter.window.end(),
                                                 [](const auto& a, const auto& b) { return a.lux < b.lux; });
  const auto below = [](const LuxReading& a, const LuxReading& b) { return a.lux <= b.lux; };
  const bool one_way = std::is_sorted(meter.window.begin(), meter.window.end(), below) ||
                       std::is_sorted(meter.window.rbegin(), meter.window.rend(), below);
  return most->lux - least->lux <= (one_way ? kSettled : kAgree) * most->lux ||
         now - meter.full_since >= (one_way ? kSettlesWithin : kFlickers);
}

std::optional<LuxReading> MeterSamples::sample(std::size_t luxmeter) const {
  const std::vector<LuxReading>& window = meters_[luxmeter].window;
  if (window.size() < 2) return std::nullopt;
  std::array<double, kReadings> lux{};
  for (std::size_t i = 0; i < window.size(); ++i) lux[i] = window[i].lux;
  std::sort(lux.begin(), lux.begin() + static_cast<std::ptrdiff_t>(window.size()));
  const std::size_t middle = window.size() / 2;
  const double median = window.size() % 2 ? lux[middle] : 0.5 * (lux[middle - 1] + lux[middle]);
  return LuxReading{luxmeter, median, window.back().taken};
}

}  // namespace luxrig
