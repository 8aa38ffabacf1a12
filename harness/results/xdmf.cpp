#include "results/xdmf.hpp"

#include <fmt/format.h>

#include "results/store.hpp"

namespace clothbench {
namespace {

/// Triangles of the result file: `vertices` of them, in `bytes` a number, at the path `positions`.
std::string mesh(const std::string& name, const std::string& h5, const std::string& triangles_at, std::size_t triangles,
                 const std::string& positions_at, std::size_t vertices, int bytes, const std::string& time) {
  return fmt::format(
      "   <Grid Name=\"{0}\" GridType=\"Uniform\">\n{7}"
      "    <Topology TopologyType=\"Triangle\" NumberOfElements=\"{1}\">\n"
      "     <DataItem Dimensions=\"{1} 3\" NumberType=\"Int\" Precision=\"8\" Format=\"HDF\">{2}:{3}</DataItem>\n"
      "    </Topology>\n"
      "    <Geometry GeometryType=\"XYZ\">\n"
      "     <DataItem Dimensions=\"{4} 3\" NumberType=\"Float\" Precision=\"{5}\" Format=\"HDF\">{2}:{6}</DataItem>\n"
      "    </Geometry>\n"
      "   </Grid>\n",
      name, triangles, h5, triangles_at, vertices, bytes, positions_at, time);
}

/// Static meshes, such as the desk under the cloth. Dynamic objects are stored as motion, not as meshes.
std::string still_meshes(const RunRecord& record, const std::string& h5) {
  std::string out;
  for (const StoredGroup& g : record.replay) {
    std::size_t vertices = 0, triangles = 0;
    bool moves = false;
    for (const StoredArray& a : g.arrays) {
      if (a.name == "position_m") vertices = a.shape[0];
      if (a.name == "triangles") triangles = a.shape[0];
      moves = moves || a.name == "joint_matrix";
    }
    if (vertices > 0 && triangles > 0 && !moves)
      out += mesh(g.path, h5, "/" + g.path + "/triangles", triangles, "/" + g.path + "/position_m", vertices, 8, "");
  }
  return out;
}

}  // namespace

void write_xdmf(const std::filesystem::path& path, const std::string& h5_name, const RunRecord& record) {
  const std::size_t triangles = record.header.triangles.size() / 3;
  const std::string still = still_meshes(record, h5_name);
  std::string out =
      "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"2.0\">\n <Domain>\n"
      "  <Grid Name=\"cloth\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  for (std::size_t k = 0; k < record.accuracy.time_s.size(); ++k) {
    const std::string time = fmt::format("    <Time Value=\"{:.9g}\"/>\n", record.accuracy.time_s[k]);
    const std::string positions = fmt::format("/frames/{:06}", k);
    // Every reader of ParaView finds the desk only if each frame has it.
    if (still.empty())
      out += mesh(fmt::format("frame {}", k), h5_name, "/triangles", triangles, positions, record.header.vertices, 4,
                  time);
    else
      out += fmt::format("   <Grid Name=\"frame {}\" GridType=\"Collection\" CollectionType=\"Spatial\">\n", k) + time +
             mesh("cloth", h5_name, "/triangles", triangles, positions, record.header.vertices, 4, "") + still +
             "   </Grid>\n";
  }
  out += "  </Grid>\n </Domain>\n</Xdmf>\n";
  write_file_atomically(path, out);
}

}  // namespace clothbench
