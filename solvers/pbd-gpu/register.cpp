#include "gpu_solver.hpp"

namespace clothbench {

void register_pbd_gpu(std::vector<SolverEntry>& out) {
  using namespace pbd_gpu;
  out.push_back({paper_info(), [](const nlohmann::json& s, const DeviceOptions& d) { return make_paper(s, d); },
                 paper_free_fall_m, vulkan::Device::list});
  out.push_back({xpbd_info(), [](const nlohmann::json& s, const DeviceOptions& d) { return make_xpbd(s, d); },
                 xpbd_free_fall_m, vulkan::Device::list});
}

}  // namespace clothbench
