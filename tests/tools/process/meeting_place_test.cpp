#include "tools/process/meeting_place.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace luxrig {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

int bound_to(const fs::path& file) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strcpy(address.sun_path, file.c_str());
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  EXPECT_EQ(::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  return fd;
}

void age(const fs::path& file) { fs::last_write_time(file, fs::file_time_type::clock::now() - 1min); }

TEST(MeetingPlace, ForgetsOnlyTheRemainsOfKilledDaemons) {
  std::string name = "/tmp/luxrig-test-XXXXXX";
  const fs::path folder = ::mkdtemp(name.data());
  for (const int port : {1, 2, 3}) std::ofstream(token_file(folder, port)) << "token";
  ::close(bound_to(socket_file(folder, 1)));  // dead
  const int lives = bound_to(socket_file(folder, 2));
  ASSERT_EQ(::listen(lives, 1), 0);
  const int being_made = bound_to(socket_file(folder, 3));  // does not listen yet
  std::ofstream(folder / "guardian-1.pid") << "1";
  for (const char* file : {"1.socket", "2.socket", "guardian-1.pid"}) age(folder / file);
  forget_dead_daemons(folder);
  EXPECT_FALSE(fs::exists(socket_file(folder, 1)));
  EXPECT_FALSE(fs::exists(token_file(folder, 1)));
  for (const int port : {2, 3}) {
    EXPECT_TRUE(fs::exists(socket_file(folder, port))) << port;
    EXPECT_TRUE(fs::exists(token_file(folder, port))) << port;
  }
  EXPECT_TRUE(fs::exists(folder / "guardian-1.pid"));
  forget_dead_daemons(folder / "none");
  ::close(lives);
  ::close(being_made);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace luxrig
