#include "tools/luxrigd/scheduling.h"

#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <thread>

namespace luxrig {

bool make_realtime(int priority) {
  sched_param parameter{};
  parameter.sched_priority = priority;
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter) == 0;
}

bool realtime_allowed() {
  bool allowed = false;
  std::thread([&] { allowed = make_realtime(1); }).join();
  return allowed;
}

bool lock_memory() {
  malloc_trim(0);  // return the solver's freed memory
  // Without ONFAULT every thread's whole stack and every arena would become resident.
  return mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0;
}

void make_background() {
  // Linux keeps the nice value per thread; child threads inherit it.
  setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), 15);
}

}  // namespace luxrig
