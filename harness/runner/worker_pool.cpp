#include "runner/worker_pool.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

namespace clothbench {

void run_tasks(const std::vector<std::function<void(RunWorker&)>>& tasks, int jobs,
               const std::filesystem::path& program, const std::filesystem::path& scratch) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr first;
  std::mutex mutex;
  const auto work = [&](int k) {
    try {
      RunWorker worker(program, scratch / std::to_string(k));
      for (std::size_t task = next++; task < tasks.size(); task = next++) tasks[task](worker);
    } catch (...) {
      next = tasks.size();
      const std::lock_guard lock(mutex);
      if (!first) first = std::current_exception();
    }
  };
  std::vector<std::thread> threads;
  for (int k = 1; k < std::min<int>(jobs, static_cast<int>(tasks.size())); ++k) threads.emplace_back(work, k);
  work(0);
  for (std::thread& t : threads) t.join();
  if (first) std::rethrow_exception(first);
}

}  // namespace clothbench
