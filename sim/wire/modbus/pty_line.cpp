#include "sim/wire/modbus/pty_line.h"

#include <fcntl.h>
#include <pty.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <system_error>

namespace luxrig::sim {
namespace {

tl::unexpected<Fault> pty_failed(const std::string& doing, int error) {
  return tl::unexpected(Fault{Cause::system, "", doing + ": " + std::generic_category().message(error), {}});
}

}  // namespace

Result<std::unique_ptr<PtyLine>> PtyLine::open(const std::string& path) {
  std::unique_ptr<PtyLine> line(new PtyLine);
  line->path_ = path;
  if (path.empty()) {
    std::error_code error;
    std::string folder = (std::filesystem::temp_directory_path(error) / "luxrig-line-XXXXXX").string();
    if (error || ::mkdtemp(folder.data()) == nullptr) return pty_failed("making a folder for a serial port", errno);
    line->folder_ = folder;
    line->path_ = folder + "/port";
  } else if (const std::string folder = std::filesystem::path(path).parent_path().string();
             !folder.empty() && ::mkdir(folder.c_str(), 0700) == 0) {
    line->folder_ = folder;  // an earlier simulator had made it for its own line
  }
  if (auto plugged = line->plug_in(); !plugged) return tl::unexpected(plugged.error());
  return line;
}

PtyLine::~PtyLine() {
  set_open(false);
  if (!folder_.empty()) ::rmdir(folder_.c_str());
}

Result<void> PtyLine::plug_in() {
  int master = -1, slave = -1;
  std::array<char, 128> name{};
  if (::openpty(&master, &slave, name.data(), nullptr, nullptr) != 0) return pty_failed("openpty", errno);
  Descriptor master_end(master), slave_end(slave);
  ::fcntl(master, F_SETFD, FD_CLOEXEC);
  ::fcntl(slave, F_SETFD, FD_CLOEXEC);
  ::fcntl(master, F_SETFL, O_NONBLOCK);
  termios raw{};
  if (::tcgetattr(slave, &raw) != 0) return pty_failed("tcgetattr", errno);
  ::cfmakeraw(&raw);
  if (::tcsetattr(slave, TCSANOW, &raw) != 0) return pty_failed("tcsetattr", errno);
  struct stat there {};
  if (::lstat(path_.c_str(), &there) == 0 && !S_ISLNK(there.st_mode)) {
    return pty_failed("linking a serial port to " + path_, EEXIST);
  }
  ::unlink(path_.c_str());
  if (::symlink(name.data(), path_.c_str()) != 0) return pty_failed("linking a serial port to " + path_, errno);
  master_ = std::move(master_end);
  slave_ = std::move(slave_end);
  return {};
}

void PtyLine::set_open(bool open) {
  if (open == master_.open()) return;
  if (open) {
    (void)plug_in();  // if it fails it stays unplugged, and the next call tries again
    return;
  }
  ::unlink(path_.c_str());
  slave_.reset();
  master_.reset();
}

std::vector<std::uint8_t> PtyLine::take() {
  std::vector<std::uint8_t> bytes;
  std::array<std::uint8_t, 1024> buffer;
  while (master_.open() && bytes.size() < 65536) {
    const auto got = ::read(master_.get(), buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    bytes.insert(bytes.end(), buffer.begin(), buffer.begin() + got);
  }
  return bytes;
}

void PtyLine::put(std::span<const std::uint8_t> bytes) {
  while (master_.open() && !bytes.empty()) {
    const auto sent = ::write(master_.get(), bytes.data(), bytes.size());
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return;
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
}

}  // namespace luxrig::sim
