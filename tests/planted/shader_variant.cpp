#include "shader_variant.hpp"

#include <unistd.h>
#include <vulkan/vulkan.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <stdexcept>

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using Code = std::vector<char>;

Code read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file.string() + ": cannot be read");
  return {std::istreambuf_iterator<char>(in), {}};
}

const std::string& build_commands() {
  static const std::string ninja = [] {
    const Code text = read(CLOTHBENCH_BUILD_NINJA);
    return std::string(text.begin(), text.end());
  }();
  return ninja;
}

/// Names of the kernels of this build, by their code; old files of an earlier build are excluded.
const std::map<Code, std::string>& built() {
  static const std::map<Code, std::string> all = [] {
    std::map<Code, std::string> out;
    for (const auto& f : fs::directory_iterator(CLOTHBENCH_KERNELS))
      if (f.path().extension() == ".spv" &&
          build_commands().find(" -o " + f.path().string() + " ") != std::string::npos)
        out.emplace(read(f.path()), f.path().string());
    return out;
  }();
  return all;
}

/// The part of the build's command that writes `spv`.
std::string command_of(const std::string& spv) {
  const std::string& ninja = build_commands();
  const std::size_t out = ninja.find(" -o " + spv + " ");
  if (out == std::string::npos) throw std::runtime_error(spv + ": no command in the build writes it");
  const std::size_t begin = ninja.rfind("&& ", out) + 3, end = ninja.find(" &&", out);
  return ninja.substr(begin, end - begin);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

struct Active {
  fs::path folder;  ///< a copy of the solver's sources with the fault
  std::map<std::string, Code> compiled;
  int exchanged = 0;
};
std::optional<Active> active;
int last_exchanged = 0;

const Code* faulty(const VkShaderModuleCreateInfo& info) {
  if (!active) return nullptr;
  const auto* bytes = reinterpret_cast<const char*>(info.pCode);
  const Code code(bytes, bytes + info.codeSize);
  const auto at = built().find(code);
  if (at == built().end()) throw std::runtime_error("the driver received a kernel that is not in " CLOTHBENCH_KERNELS);
  if (!active->compiled.contains(at->second)) {
    const std::string out = (active->folder / "out.spv").string();
    const std::string command = replaced(replaced(command_of(at->second), at->second, out),
                                         CLOTHBENCH_KERNEL_SOURCES "/", active->folder.string() + "/");
    if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
    active->compiled[at->second] = read(out);
  }
  const Code& now = active->compiled[at->second];
  active->exchanged += now != code;
  return &now;
}

}  // namespace

ShaderVariant::ShaderVariant(const ShaderFault& fault) {
  Active a;
  a.folder = fs::temp_directory_path() / ("clothbench-planted-" + std::to_string(::getpid()));
  fs::remove_all(a.folder);
  for (const auto& f : fs::recursive_directory_iterator(CLOTHBENCH_KERNEL_SOURCES)) {
    const fs::path to = a.folder / fs::relative(f.path(), CLOTHBENCH_KERNEL_SOURCES);
    const std::string kind = f.path().extension().string();
    if (kind != ".comp" && kind != ".glsl" && kind != ".h") continue;
    fs::create_directories(to.parent_path());
    fs::copy(f.path(), to);
  }
  const fs::path file = a.folder / fault.file;
  const Code code = read(file);
  std::string text(code.begin(), code.end());
  const std::size_t at = text.find(fault.is);
  if (at == std::string::npos || text.find(fault.is, at + 1) != std::string::npos)
    throw std::runtime_error("solvers/pbd-gpu/" + fault.file + ": expected exactly once: " + fault.is);
  text.replace(at, fault.is.size(), fault.is_to_be);
  std::ofstream(file) << text;
  active = std::move(a);
}

ShaderVariant::~ShaderVariant() {
  std::error_code ignored;
  fs::remove_all(active->folder, ignored);
  last_exchanged = active->exchanged;
  active.reset();
}

int ShaderVariant::exchanged() { return active ? active->exchanged : last_exchanged; }

}  // namespace clothbench

extern "C" {
VkResult __real_vkCreateShaderModule(VkDevice, const VkShaderModuleCreateInfo*, const VkAllocationCallbacks*,
                                     VkShaderModule*);

VkResult __wrap_vkCreateShaderModule(VkDevice device, const VkShaderModuleCreateInfo* info,
                                     const VkAllocationCallbacks* a, VkShaderModule* module) {
  const std::vector<char>* code = clothbench::faulty(*info);
  if (code == nullptr) return __real_vkCreateShaderModule(device, info, a, module);
  VkShaderModuleCreateInfo changed = *info;
  changed.codeSize = code->size();
  changed.pCode = reinterpret_cast<const std::uint32_t*>(code->data());
  return __real_vkCreateShaderModule(device, &changed, a, module);
}
}
