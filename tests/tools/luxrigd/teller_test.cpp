#include "tools/luxrigd/teller.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <string>

#include "tools/process/clock.h"

namespace luxrig {
namespace {

using namespace std::chrono_literals;

struct Pipe {
  Pipe() {
    int ends[2];
    EXPECT_EQ(::pipe2(ends, O_CLOEXEC), 0);
    read = ends[0];
    write = ends[1];
  }
  ~Pipe() {
    if (read >= 0) ::close(read);
    if (write >= 0) ::close(write);
  }
  void hang_up() {
    ::close(read);
    read = -1;
  }
  [[nodiscard]] std::string take() const {
    std::string text(1 << 20, '\0');
    const ssize_t got = ::read(read, text.data(), text.size());
    text.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return text;
  }
  int read = -1, write = -1;
};

TEST(Teller, WritesInOrder) {
  const Pipe pipe;
  Teller teller(pipe.write);
  teller.tell("one\n");
  teller.tell("two\n");
  EXPECT_TRUE(teller.flush(10s));
  EXPECT_EQ(pipe.take(), "one\ntwo\n");
}

TEST(Teller, DoesNotWaitForAReaderThatNeverReads) {
  ::signal(SIGPIPE, SIG_IGN);
  Pipe pipe;
  const Time begun = now();
  {
    Teller teller(pipe.write);
    const std::string line(10000, 'x');
    for (int i = 0; i < 2000; ++i) teller.tell(line + "\n");  // 20 MB into a pipe of 64 KiB
    EXPECT_FALSE(teller.flush(50ms));
    EXPECT_LT(now() - begun, 5s);
  }
  EXPECT_LT(now() - begun, 10s) << "nor at its end";
  pipe.write = -1;  // not closed: the teller's thread may still be writing to it
}

TEST(Teller, SurvivesAClosedPipeAndAFullDisk) {
  ::signal(SIGPIPE, SIG_IGN);
  Pipe pipe;
  pipe.hang_up();
  const int full = ::open("/dev/full", O_WRONLY | O_CLOEXEC);
  for (const int fd : {pipe.write, full, -1}) {
    Teller teller(fd);
    teller.tell("lost\n");
    (void)teller.flush(100ms);
    teller.tell("lost, too\n");
  }
  ::close(full);
}

}  // namespace
}  // namespace luxrig
