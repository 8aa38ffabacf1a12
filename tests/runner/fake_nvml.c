/* NVIDIA's management library with one GPU, which draws 300 W, lacks ECC, and is at 1980 MHz and 41 degrees. */
#include <string.h>
#include <time.h>

int nvmlInit_v2(void) { return 0; }
int nvmlDeviceGetHandleByUUID(const char* uuid, void** device) {
  *device = (void*)uuid;
  return strcmp(uuid, "GPU-00112233-4455-6677-8899-aabbccddeeff") == 0 ? 0 : 6;
}
int nvmlDeviceGetClockInfo(void* device, int clock, unsigned* mhz) {
  *mhz = 1980;
  return device != 0 && clock == 1 ? 0 : 2;
}
int nvmlDeviceGetTemperature(void* device, int sensor, unsigned* celsius) {
  *celsius = 41;
  return device != 0 && sensor == 0 ? 0 : 2;
}
int nvmlDeviceGetTotalEnergyConsumption(void* device, unsigned long long* mj) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  *mj = (unsigned long long)(300 * (1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec));
  return device != 0 ? 0 : 2;
}
int nvmlDeviceGetEnforcedPowerLimit(void* device, unsigned* mw) {
  *mw = 700000;
  return device != 0 ? 0 : 2;
}
int nvmlDeviceGetEccMode(void* device, unsigned* now, unsigned* pending) {
  *now = *pending = 1;
  return device != 0 ? 3 : 2; /* not supported */
}
