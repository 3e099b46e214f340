#include "postproc/system/parallel_for.h"

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>

namespace batten::postproc {

int threads_at_once(int asked) {
  const int cores = oneapi::tbb::info::default_concurrency();
  return asked > 0 ? std::min(asked, cores) : cores;
}

void parallel_for(int threads, std::size_t count, const std::function<void(std::size_t)>& one) {
  const auto all = [&] { oneapi::tbb::parallel_for(std::size_t{0}, count, one); };
  if (threads == kThreadsOfCaller) {
    // A thread that waits here must not begin with other work of the caller.
    oneapi::tbb::this_task_arena::isolate(all);
    return;
  }
  oneapi::tbb::task_arena arena(threads_at_once(threads));
  arena.execute(all);
}

}  // namespace batten::postproc
