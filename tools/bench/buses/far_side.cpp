#include "tools/bench/buses/far_side.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>

namespace luxrig {

Result<std::unique_ptr<FarSide>> FarSide::open(const Rig& rig, bool driver_waits, std::uint64_t seed) {
  std::unique_ptr<FarSide> side(new FarSide(seed));
  const auto rows = static_cast<Eigen::Index>(rig.points.size() + rig.luxmeters.size());
  auto world = sim::World::make(rig, sim::Deviations::none(),
                                Eigen::MatrixXd::Constant(rows, static_cast<Eigen::Index>(rig.fixtures.size()), 100.0));
  if (!world) return tl::unexpected(world.error());
  side->world_ = std::move(*world);
  auto endpoint = sim::open_endpoint({rig, 0, *side->world_, side->faults_}, 0);
  if (!endpoint) return tl::unexpected(endpoint.error());
  side->endpoint_ = std::move(*endpoint);
  if (driver_waits) {
    side->base_real_ = std::chrono::steady_clock::now();
    side->wake_ = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    if (side->wake_ < 0) return tl::unexpected(Fault{Cause::system, {}, "no eventfd", {}});
    side->thread_ = std::thread([raw = side.get()] { raw->run(); });
  }
  return side;
}

FarSide::~FarSide() {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
  if (wake_ >= 0) ::close(wake_);
}

Time FarSide::step_to(Time at) {
  if (wake_ < 0) {
    now_ = std::max(now_, at);
    serve_now();
    return now_;
  }
  std::uint64_t wanted = 0;
  {
    const std::lock_guard lock(mutex_);
    base_ = std::max(at, now_);
    base_real_ = std::chrono::steady_clock::now();
    wanted = rounds_ + 1;
  }
  const std::uint64_t one = 1;
  (void)!::write(wake_, &one, sizeof one);
  for (std::uint64_t seen = rounds_; seen < wanted; seen = rounds_) rounds_.wait(seen);
  const std::lock_guard lock(mutex_);
  return now_;
}

std::vector<double> FarSide::levels() const {
  const std::lock_guard lock(mutex_);
  return world_->levels();
}

void FarSide::serve_now() {
  endpoint_->serve(now_);
  world_->advance(now_);
}

void FarSide::run() {
  std::vector<int> descriptors;
  std::vector<pollfd> waits;
  while (!stopping_) {
    descriptors.clear();
    waits.clear();
    {
      const std::lock_guard lock(mutex_);
      const auto since = std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now() - base_real_);
      now_ = std::max(now_, base_ + since);
      serve_now();
      endpoint_->descriptors(descriptors);
      ++rounds_;
    }
    rounds_.notify_all();
    waits.push_back({wake_, POLLIN, 0});
    for (const int fd : descriptors) waits.push_back({fd, POLLIN, 0});
    ::poll(waits.data(), waits.size(), 1);
    std::uint64_t count = 0;
    (void)!::read(wake_, &count, sizeof count);
  }
}

}  // namespace luxrig
