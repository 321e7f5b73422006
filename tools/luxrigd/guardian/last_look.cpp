#include "tools/luxrigd/guardian/last_look.h"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "drivers/io/os_fault.h"

namespace luxrig {
namespace {

constexpr std::uint64_t kMagic = 0x334b4f4f4c58554cULL;  // "LUXLOOK3"
constexpr std::size_t kHeadNumbers = 3;                  // sends, hold, fade
constexpr std::size_t kFixtureNumbers = 6;               // present, safe, pan, tilt, beam, silent
constexpr double kLongest_s = 1e6;

std::size_t numbers_of(std::size_t fixtures) { return kHeadNumbers + kFixtureNumbers * fixtures; }

double within(double value, double least, double most) {
  return std::isfinite(value) ? std::clamp(value, least, most) : least;
}

}  // namespace

struct LastLookMemory::Header {
  std::uint64_t magic = kMagic;
  std::uint64_t fixtures = 0;
  std::atomic<std::uint32_t> newest{0};  ///< 1 + index of the whole copy; 0 = none yet
  std::atomic<std::uint32_t> ended{0};
  std::atomic<std::uint32_t> guardian_has_the_light{0};
  std::atomic<std::uint32_t> beats[3]{};  ///< by Beat
};

LastLookMemory::Header& LastLookMemory::header() const { return *static_cast<Header*>(memory_); }

double* LastLookMemory::copy(std::uint32_t index) const {
  return reinterpret_cast<double*>(static_cast<std::byte*>(memory_) + sizeof(Header)) + index * numbers_of(fixtures_);
}

Result<LastLookMemory> LastLookMemory::create(std::size_t fixtures) {
  const std::size_t bytes = sizeof(Header) + 2 * numbers_of(fixtures) * sizeof(double);
  const int fd = ::memfd_create("luxrig-last-look", MFD_CLOEXEC);
  if (fd < 0) return tl::unexpected(os_fault("making memory for the guardian", errno));
  void* memory = MAP_FAILED;
  if (::ftruncate(fd, static_cast<off_t>(bytes)) == 0)
    memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (memory == MAP_FAILED) {
    const int error = errno;
    ::close(fd);
    return tl::unexpected(os_fault("making memory for the guardian", error));
  }
  new (memory) Header;
  LastLookMemory made(fd, memory, bytes, fixtures);
  made.header().fixtures = fixtures;
  return made;
}

Result<LastLookMemory> LastLookMemory::open(int fd, std::size_t fixtures) {
  const std::size_t bytes = sizeof(Header) + 2 * numbers_of(fixtures) * sizeof(double);
  struct stat about {};
  if (::fstat(fd, &about) != 0) return tl::unexpected(os_fault("looking at the daemon's memory", errno));
  if (about.st_size != static_cast<off_t>(bytes)) return refusal("the daemon's memory is of another rig");
  void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (memory == MAP_FAILED) return tl::unexpected(os_fault("mapping the daemon's memory", errno));
  LastLookMemory opened(fd, memory, bytes, fixtures);
  if (opened.header().magic != kMagic || opened.header().fixtures != fixtures)
    return refusal("the daemon's memory is of another rig");
  return opened;
}

LastLookMemory::LastLookMemory(LastLookMemory&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      memory_(std::exchange(other.memory_, nullptr)),
      bytes_(other.bytes_),
      fixtures_(other.fixtures_) {}

LastLookMemory::~LastLookMemory() {
  if (memory_ != nullptr) ::munmap(memory_, bytes_);
  if (fd_ >= 0) ::close(fd_);
}

void LastLookMemory::put(const LightInForce& light, bool sends) {
  const std::uint32_t newest = header().newest.load(std::memory_order_relaxed);
  const std::uint32_t other = newest == 1 ? 1 : 0;
  double* at = copy(other);
  *at++ = sends ? 1 : 0;
  *at++ = light.hold_s;
  *at++ = light.fade_s;
  for (std::size_t f = 0; f < fixtures_; ++f) {
    *at++ = light.look.levels[f];
    *at++ = light.safe_levels[f];
    const Joints& joints = light.look.joints[f];
    *at++ = joints.pan_rad;
    *at++ = joints.tilt_rad;
    *at++ = joints.beam_rad;
    *at++ = light.silent[f] != 0 ? 1 : 0;
  }
  header().newest.store(other + 1, std::memory_order_release);
}

std::optional<LightInForce> LastLookMemory::take() const {
  const std::uint32_t newest = header().newest.load(std::memory_order_acquire);
  if (newest != 1 && newest != 2) return std::nullopt;
  const double* at = copy(newest - 1);
  if (*at++ != 1) return std::nullopt;
  LightInForce light;
  light.hold_s = within(*at++, 0, kLongest_s);
  light.fade_s = within(*at++, 0, kLongest_s);
  for (std::size_t f = 0; f < fixtures_; ++f) {
    light.look.levels.push_back(within(*at++, 0, 1));
    light.safe_levels.push_back(within(*at++, 0, 1));
    Joints joints;
    for (double* angle_rad : {&joints.pan_rad, &joints.tilt_rad, &joints.beam_rad}) {
      if (std::isfinite(*at)) *angle_rad = *at;
      ++at;
    }
    light.look.joints.push_back(joints);
    light.silent.push_back(*at++ == 1 ? 1 : 0);
  }
  return light;
}

void LastLookMemory::beat(Beat whose) {
  header().beats[static_cast<std::size_t>(whose)].fetch_add(1, std::memory_order_relaxed);
}
std::uint32_t LastLookMemory::beats(Beat whose) const {
  return header().beats[static_cast<std::size_t>(whose)].load(std::memory_order_relaxed);
}

void LastLookMemory::take_the_light() { header().guardian_has_the_light.store(1); }
void LastLookMemory::take_the_light_back() { header().guardian_has_the_light.store(0); }
bool LastLookMemory::guardian_has_the_light() const { return header().guardian_has_the_light.load() == 1; }

void LastLookMemory::end() { header().ended.store(1, std::memory_order_release); }
bool LastLookMemory::ended() const { return header().ended.load(std::memory_order_acquire) == 1; }

}  // namespace luxrig
