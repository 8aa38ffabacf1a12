// Result files. The input is a list of changes to a valid file, made with the library: removed fields, other shapes,
// types and values. Damage to the library's own structures is not tested: some of it crashes inside the library.
#include <hdf5.h>

#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "../results/sample_run.hpp"
#include "fuzz.hpp"
#include "results/part_file.hpp"

namespace {

namespace fs = std::filesystem;

/// The valid file's bytes, its objects by path, and its attributes by path and name.
struct Sample {
  std::vector<char> bytes;
  std::vector<std::string> objects;
  std::vector<std::pair<std::string, std::string>> attributes;
};

herr_t note_attribute(hid_t, const char* name, const H5A_info_t*, void* to) {
  static_cast<std::vector<std::string>*>(to)->push_back(name);
  return 0;
}

herr_t note_object(hid_t file, const char* name, const H5O_info_t*, void* to) {
  auto& s = *static_cast<Sample*>(to);
  if (std::strcmp(name, ".") != 0) s.objects.push_back(name);
  std::vector<std::string> names;
  const hid_t object = H5Oopen(file, name, H5P_DEFAULT);
  H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, note_attribute, &names);
  H5Oclose(object);
  for (const std::string& n : names) s.attributes.emplace_back(name, n);
  return 0;
}

const Sample& sample() {
  static const Sample s = [] {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    const fs::path path = fs::temp_directory_path() / ("clothbench-fuzz-" + std::to_string(getpid()) + ".h5");
    clothbench::write_hdf5(path, clothbench::sample_run());
    Sample out;
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, note_object, &out);
    H5Fclose(file);
    out.bytes.resize(fs::file_size(path));
    FILE* in = std::fopen(path.c_str(), "rb");
    if (std::fread(out.bytes.data(), 1, out.bytes.size(), in) != out.bytes.size()) std::abort();
    std::fclose(in);
    fs::remove(path);
    return out;
  }();
  return s;
}

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  bool any() const { return left_ > 0; }
  std::uint8_t next() { return left_ == 0 ? 0 : (--left_, *data_++); }
  std::string text(std::size_t most) {
    const std::size_t n = std::min(most, left_);
    std::string out(reinterpret_cast<const char*>(data_), n);
    data_ += n;
    left_ -= n;
    return out;
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

hid_t some_type(std::uint8_t k) {
  switch (k % 7) {
    case 0:
      return H5Tcopy(H5T_NATIVE_DOUBLE);
    case 1:
      return H5Tcopy(H5T_NATIVE_INT64);
    case 2:
      return H5Tcopy(H5T_NATIVE_UINT8);
    case 3:
      return H5Tcopy(H5T_NATIVE_FLOAT);
    case 6: {
      const hid_t compound = H5Tcreate(H5T_COMPOUND, 8);
      H5Tinsert(compound, "x", 0, H5T_NATIVE_DOUBLE);
      return compound;
    }
    default: {
      const hid_t t = H5Tcopy(H5T_C_S1);
      H5Tset_size(t, k % 7 == 4 ? 5 : H5T_VARIABLE);
      return t;
    }
  }
}

hid_t some_space(Bytes& b) {
  const int rank = b.next() % 4;
  hsize_t dims[3];
  for (hsize_t& d : dims) d = b.next() % 8;
  return rank == 0 ? H5Screate(b.next() % 2 == 0 ? H5S_SCALAR : H5S_NULL) : H5Screate_simple(rank, dims, nullptr);
}

void put_attribute(hid_t file, const std::pair<std::string, std::string>& at, hid_t type, hid_t space,
                   const void* value = nullptr) {
  H5Adelete_by_name(file, at.first.c_str(), at.second.c_str(), H5P_DEFAULT);
  const hid_t a =
      H5Acreate_by_name(file, at.first.c_str(), at.second.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  if (a >= 0 && value != nullptr) H5Awrite(a, type, value);
  if (a >= 0) H5Aclose(a);
}

void put_dataset(hid_t file, const std::string& name, hid_t type, hid_t space, const void* value = nullptr) {
  H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  const hid_t d = H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  if (d >= 0 && value != nullptr) H5Dwrite(d, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value);
  if (d >= 0) H5Dclose(d);
}

void change(hid_t file, Bytes& b) {
  const Sample& s = sample();
  const int what = b.next() % 8;
  const std::string& object = s.objects[(b.next() | b.next() << 8) % s.objects.size()];
  const auto& attribute = s.attributes[(b.next() | b.next() << 8) % s.attributes.size()];
  if (what == 0) {
    H5Ldelete(file, object.c_str(), H5P_DEFAULT);
  } else if (what == 1) {
    H5Adelete_by_name(file, attribute.first.c_str(), attribute.second.c_str(), H5P_DEFAULT);
  } else if (what == 2 || what == 3) {
    const hid_t type = some_type(b.next()), space = some_space(b);
    what == 2 ? put_dataset(file, object, type, space) : put_attribute(file, attribute, type, space);
    H5Sclose(space);
    H5Tclose(type);
  } else if (what == 4 || what == 5) {  // a number, or a text, as attribute
    const std::string text = b.text(what == 4 ? 8 : b.next());
    const hid_t space = H5Screate(H5S_SCALAR), type = what == 4 ? H5Tcopy(H5T_NATIVE_DOUBLE) : H5Tcopy(H5T_C_S1);
    if (what == 5) H5Tset_size(type, text.size() + 1);
    double number = 0;
    std::memcpy(&number, text.data(), std::min<std::size_t>(8, text.size()));
    put_attribute(file, attribute, type, space, what == 4 ? static_cast<const void*>(&number) : text.c_str());
    H5Tclose(type);
    H5Sclose(space);
  } else if (what == 6) {  // a dataset's numbers
    const hid_t d = H5Dopen2(file, object.c_str(), H5P_DEFAULT);
    if (d < 0) return;
    const hid_t space = H5Dget_space(d);
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    if (count > 0 && count < 10000) {
      std::vector<double> values(static_cast<std::size_t>(count));
      const std::string text = b.text(16);
      for (std::size_t k = 0; k < values.size(); ++k)
        if (!text.empty())
          std::memcpy(&values[k], text.data() + 8 * (k % 2) % text.size(),
                      std::min<std::size_t>(8, text.size() - 8 * (k % 2) % text.size()));
      H5Dwrite(d, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    }
    H5Sclose(space);
    H5Dclose(d);
  } else {  // the header, as JSON
    const std::string text = b.text(4096);
    const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(type, H5T_VARIABLE);
    const char* at = text.c_str();
    put_dataset(file, "header_json", type, space, &at);
    H5Sclose(space);
    H5Tclose(type);
  }
}

}  // namespace

void clothbench::fuzz_hdf5(const std::uint8_t* data, std::size_t size) {
  const Sample& s = sample();
  const MemoryFile memory(s.bytes.data(), s.bytes.size());
  Bytes bytes(data, size);
  const hid_t file = H5Fopen(memory.path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  if (file < 0) std::abort();
  for (int k = 0; k < 8 && bytes.any(); ++k) change(file, bytes);
  H5Fclose(file);
  for (const std::size_t stride : {0, 1, 2}) reads_or_refuses([&] { read_hdf5(memory.path(), stride); });
}
