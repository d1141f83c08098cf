# A headless macula-client in a container, for tests of a server from elsewhere. From the root of the source:
#   docker build -f deploy/docker/client.Dockerfile -t macula-client .
#   docker run --rm -it -v client-keys:/keys macula-client pair --connect tcp://SERVER:7789
#   docker run --rm -v client-keys:/keys -v "$PWD/out:/out" macula-client --connect tcp://SERVER:7788 --frames 300
FROM debian:12-slim AS build
COPY deploy/install.sh deploy/common.sh deploy/packages.txt /macula/deploy/
RUN /macula/deploy/install.sh build package
COPY . /macula
RUN cd /macula && ./deploy/package.sh --no-install

FROM debian:12-slim
COPY --from=build /macula/build/packages/macula-client_*.deb /tmp/
RUN apt-get update \
    && apt-get install -y --no-install-recommends /tmp/macula-client_*.deb \
    && rm -rf /var/lib/apt/lists/* /tmp/macula-client_*.deb \
    && useradd --system --home-dir /nonexistent --shell /usr/sbin/nologin viewer \
    && install -d -o viewer -g viewer -m 0700 /keys \
    && install -d -o viewer -g viewer /out
USER viewer
WORKDIR /out
VOLUME /keys /out
ENV XDG_CONFIG_HOME=/keys
ENTRYPOINT ["macula-client"]
CMD ["--display", "headless", "--out", "/out"]
