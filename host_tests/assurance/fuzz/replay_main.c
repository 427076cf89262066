/* Runs a fuzz target with every file of the folders on the command line, for compilers without libFuzzer. */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int replay(const char *path) {
    static uint8_t data[1 << 16];
    FILE *file = fopen(path, "rb");
    if (file == NULL) return 0;
    const size_t size = fread(data, 1, sizeof data, file);
    fclose(file);
    LLVMFuzzerTestOneInput(data, size);
    return 1;
}

int main(int count, char **folders) {
    int files = 0;
    for (int k = 1; k < count; k++) {
        DIR *folder = opendir(folders[k]);
        if (folder == NULL) {
            fprintf(stderr, "%s: no such folder\n", folders[k]);
            return 2;
        }
        for (const struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
            char path[4096];
            snprintf(path, sizeof path, "%s/%s", folders[k], entry->d_name);
            if (entry->d_name[0] != '.') files += replay(path);
        }
        closedir(folder);
    }
    printf("%d files replayed\n", files);
    return files > 0 ? 0 : 1;
}
