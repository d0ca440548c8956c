# The program holotrace in a container:
#   docker build -t holotrace .
#   docker run --rm --user "$(id -u):$(id -g)" -v "$PWD:/work" holotrace run examples/chess_photoreal.toml -o out/chess
# Without display on a monitor, MPI and the Python package.

FROM debian:12 AS build
SHELL ["/bin/bash", "-euo", "pipefail", "-c"]
WORKDIR /source
COPY scripts/setup scripts/setup
COPY scripts/requirements scripts/requirements
RUN scripts/setup --program && rm -rf /var/lib/apt/lists/*
COPY . .
RUN cmake --preset program && cmake --build --preset program && \
    cmake --install build/release --component program --strip
# The packages of the libraries that the program loads, libtiff and the loader of OpenCL at run time.
RUN ldd /usr/local/bin/holotrace | awk '/=> \// {print "*/" $1}' | xargs dpkg -S | cut -d: -f1 | sort -u >/packages && \
    echo libtiff6 ocl-icd-libopencl1 >>/packages
# Open Image Denoise, its part for processors. It finds that in a folder called lib.
RUN mkdir -p /oidn/lib && \
    cp build/python/lib/python3*/site-packages/pyoidn/oidn/lib/libOpenImageDenoise{,_core,_device_cpu}.so.2* /oidn/lib

FROM debian:12-slim
COPY --from=build /packages /packages
RUN apt-get update -qq && xargs apt-get install -y -qq --no-install-recommends </packages && rm -rf /var/lib/apt/lists/*
COPY --from=build /usr/local/bin/holotrace /usr/local/bin/holotrace
COPY --from=build /usr/local/share/holotrace /usr/local/share/holotrace
COPY --from=build /oidn /usr/local/lib/oidn
ENV HOLOTRACE_OIDN=/usr/local/lib/oidn/lib
RUN useradd --create-home holotrace
USER holotrace
WORKDIR /work
ENTRYPOINT ["holotrace"]
CMD ["--help"]
