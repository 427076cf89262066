/* A peer of the robot on Fast DDS, set up as ROS 2's middleware for it does: names, quality of service, user data. It
 * drives by cmd_vel, hears every topic, reads the graph, and prints what it saw as JSON.
 *
 *     peer DOMAIN SECONDS COMMANDS_PER_SECOND twist|stamped|garbage|call|none X Z
 */
#include "peerPubSubTypes.h"
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

using namespace eprosima::fastdds::dds;
using namespace eprosima::fastrtps::rtps;

static const int PORT_BASE = 7400, PORTS_OF_DOMAIN = 250, PORTS_OF_PARTICIPANT = 2, PARTICIPANTS = 8;

static const int SHORTER_THAN_A_TWIST = 40; /* characters; from 44 on, bytes of a text are six numbers, in ROS too */

static int64_t now_ns() {
    using namespace std::chrono;
    return duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count();
}

template <class Qos> static void set_user_data(Qos &qos, const char *text) {
    qos.user_data().setValue(std::vector<octet>(text, text + std::strlen(text)));
}

/* What discovery says of the robot's endpoints. */
struct Watch : DomainParticipantListener {
    std::mutex lock;
    std::map<std::string, std::string> found;

    void enter(const std::string &kind, const std::string &topic, const std::string &type,
               const std::vector<octet> &data, bool is_reliable, bool is_latched) {
        std::lock_guard<std::mutex> guard(lock);
        found[kind + " " + topic + " " + type] = std::string(data.begin(), data.end()) + "|" +
                                    (is_reliable ? "reliable" : "best effort") + "|" +
                                    (is_latched ? "latched" : "volatile");
    }
    void on_publisher_discovery(DomainParticipant *, WriterDiscoveryInfo &&w) override {
        const auto &qos = w.info.m_qos;
        enter("writer", w.info.topicName().c_str(), w.info.typeName().c_str(), qos.m_userData.data_vec(),
              qos.m_reliability.kind == RELIABLE_RELIABILITY_QOS, qos.m_durability.kind == TRANSIENT_LOCAL_DURABILITY_QOS);
    }
    void on_subscriber_discovery(DomainParticipant *, ReaderDiscoveryInfo &&r) override {
        const auto &qos = r.info.m_qos;
        enter("reader", r.info.topicName().c_str(), r.info.typeName().c_str(), qos.m_userData.data_vec(),
              qos.m_reliability.kind == RELIABLE_RELIABILITY_QOS, qos.m_durability.kind == TRANSIENT_LOCAL_DURABILITY_QOS);
    }
};

/* Counts the messages of one topic, and keeps the last. */
template <class Message> struct Heard : DataReaderListener {
    std::mutex lock;
    Message last;
    long count = 0, lost = 0;
    std::vector<double> late_us;

    static int64_t stamp_of(const nav_msgs::msg::dds_::Odometry_ &m) { return of(m.header().stamp()); }
    static int64_t stamp_of(const sensor_msgs::msg::dds_::JointState_ &m) { return of(m.header().stamp()); }
    static int64_t stamp_of(const sensor_msgs::msg::dds_::Imu_ &m) { return of(m.header().stamp()); }
    static int64_t stamp_of(const tf2_msgs::msg::dds_::TFMessage_ &m) {
        return m.transforms().empty() ? 0 : of(m.transforms()[0].header().stamp());
    }
    template <class Other> static int64_t stamp_of(const Other &) { return 0; }
    static int64_t of(const builtin_interfaces::msg::dds_::Time_ &t) { return t.sec() * 1000000000LL + t.nanosec(); }

    void on_sample_lost(DataReader *, const SampleLostStatus &status) override { lost = status.total_count; }
    void on_data_available(DataReader *reader) override {
        Message message;
        SampleInfo info;
        while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
            if (!info.valid_data) continue;
            std::lock_guard<std::mutex> guard(lock);
            late_us.push_back((now_ns() - stamp_of(message)) * 1e-3);
            last = message;
            ++count;
        }
    }
    void print(const char *name) {
        std::lock_guard<std::mutex> guard(lock);
        std::vector<double> sorted(late_us.begin() + late_us.size() / 10, late_us.end());
        std::sort(sorted.begin(), sorted.end());
        const double median = sorted.empty() ? -1 : sorted[sorted.size() / 2];
        const double high = sorted.empty() ? -1 : sorted[sorted.size() * 99 / 100];
        std::printf(" \"%s\": {\"count\": %ld, \"lost\": %ld, \"median_us\": %.1f, \"high_us\": %.1f},\n", name, count,
                    lost, median, high);
    }
};

/* The client of a service, as rmw_fastrtps has it: a response belongs to a request by an identity in its header, whose
 * GUID is that of the client's reader. */
struct Client : DataReaderListener {
    std::mutex lock;
    GUID_t own;
    std::vector<std::string> answers;
    long sent = 0, of_others = 0;

    void call(DataWriter *writer, long number) {
        rcl_interfaces::srv::dds_::GetParameterTypes_Request_ request;
        request.names({"use_sim_time", "watchdog_s", "scene", "nothing"});
        if (number % 2) request.names().pop_back();
        WriteParams params;
        params.related_sample_identity().writer_guid() = own;
        writer->write(&request, params);
        ++sent;
    }
    void on_data_available(DataReader *reader) override {
        rcl_interfaces::srv::dds_::GetParameterTypes_Response_ response;
        SampleInfo info;
        while (reader->take_next_sample(&response, &info) == ReturnCode_t::RETCODE_OK) {
            if (!info.valid_data) continue;
            std::lock_guard<std::mutex> guard(lock);
            if (info.related_sample_identity.writer_guid() != own) {
                ++of_others;
                continue;
            }
            std::string text = std::to_string(info.related_sample_identity.sequence_number().to64long());
            for (octet type : response.types()) text += "," + std::to_string(type);
            answers.push_back("[" + text + "]");
        }
    }
    void print() {
        std::lock_guard<std::mutex> guard(lock);
        std::printf(" \"requests\": %ld, \"of_others\": %ld, \"answers\": [", sent, of_others);
        for (size_t k = 0; k < answers.size(); ++k) std::printf("%s%s", k ? ", " : "", answers[k].c_str());
        std::printf("],\n");
    }
};

struct Peer {
    Watch watch;
    DomainParticipant *participant;
    Publisher *publisher;
    Subscriber *subscriber;

    explicit Peer(int domain) {
        DomainParticipantQos qos;
        auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
        udp->interfaceWhiteList.emplace_back("127.0.0.1");
        qos.transport().use_builtin_transports = false;
        qos.transport().user_transports.push_back(udp);
        set_user_data(qos, "enclave=/;");
        Locator_t here;
        IPLocator::setIPv4(here, 127, 0, 0, 1);
        qos.wire_protocol().builtin.metatrafficUnicastLocatorList.push_back(here);
        for (int k = 0; k < PARTICIPANTS; ++k) {
            here.port = PORT_BASE + PORTS_OF_DOMAIN * domain + 10 + PORTS_OF_PARTICIPANT * k;
            qos.wire_protocol().builtin.initialPeersList.push_back(here);
        }
        participant = DomainParticipantFactory::get_instance()->create_participant(domain, qos, &watch,
                                                                                   StatusMask::none());
        publisher = participant->create_publisher(PUBLISHER_QOS_DEFAULT);
        subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
    }
    Topic *topic(TypeSupport type, const char *topic_name, const char *type_name) {
        type->setName(type_name);
        type->auto_fill_type_information(false); /* as rmw_fastrtps: types are known by their names */
        type->auto_fill_type_object(false);
        type.register_type(participant);
        return participant->create_topic(topic_name, type_name, TOPIC_QOS_DEFAULT);
    }
    template <class Listener> DataReader *hear(TypeSupport type, const char *name, const char *type_name, Listener &listener,
                                        int depth, bool is_latched = false) {
        DataReaderQos qos;
        qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
        qos.durability().kind = is_latched ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
        qos.history().depth = depth;
        qos.endpoint().history_memory_policy = PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
        qos.type_consistency().representation.m_value.push_back(XCDR_DATA_REPRESENTATION);
        return subscriber->create_datareader(topic(type, name, type_name), qos, &listener);
    }
    DataWriter *send(TypeSupport type, const char *name, const char *type_name) {
        DataWriterQos qos;
        qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
        qos.history().depth = 10;
        qos.endpoint().history_memory_policy = PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
        qos.representation().m_value.push_back(XCDR_DATA_REPRESENTATION);
        return publisher->create_datawriter(topic(type, name, type_name), qos);
    }
};

#define TYPE(package, name) TypeSupport(new package::msg::dds_::name##_PubSubType)

static void print_doubles(const char *name, const std::vector<double> &values) {
    std::printf(" \"%s\": [", name);
    for (size_t k = 0; k < values.size(); ++k) std::printf("%s%.17g", k ? ", " : "", values[k]);
    std::printf("],\n");
}

int main(int count, char **word) {
    if (count < 7) return 2;
    const double seconds = std::atof(word[2]), per_second = std::atof(word[3]);
    const std::string kind = word[4];
    Peer peer(std::atoi(word[1]));
    Heard<nav_msgs::msg::dds_::Odometry_> odom, truth;
    Heard<tf2_msgs::msg::dds_::TFMessage_> tf, fixed;
    Heard<sensor_msgs::msg::dds_::JointState_> joints;
    Heard<sensor_msgs::msg::dds_::Imu_> imu;
    Heard<rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_> graph;
    const char *odometry = "nav_msgs::msg::dds_::Odometry_", *transforms = "tf2_msgs::msg::dds_::TFMessage_";
    peer.hear(TYPE(nav_msgs, Odometry), "rt/odom", odometry, odom, 1000);
    peer.hear(TYPE(nav_msgs, Odometry), "rt/ground_truth/odom", odometry, truth, 1000);
    peer.hear(TYPE(tf2_msgs, TFMessage), "rt/tf", transforms, tf, 1000);
    peer.hear(TYPE(tf2_msgs, TFMessage), "rt/tf_static", transforms, fixed, 1, true);
    peer.hear(TYPE(sensor_msgs, JointState), "rt/joint_states", "sensor_msgs::msg::dds_::JointState_", joints, 1000);
    peer.hear(TYPE(sensor_msgs, Imu), "rt/imu", "sensor_msgs::msg::dds_::Imu_", imu, 1000);
    peer.hear(TYPE(rmw_dds_common, ParticipantEntitiesInfo), "ros_discovery_info",
              "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_", graph, 1, true);
    const char *twist = "geometry_msgs::msg::dds_::Twist_", *stamped = "geometry_msgs::msg::dds_::TwistStamped_";
    DataWriter *writer = nullptr;
    if (kind == "stamped") writer = peer.send(TYPE(geometry_msgs, TwistStamped), "rt/cmd_vel", stamped);
    if (kind == "twist") writer = peer.send(TYPE(geometry_msgs, Twist), "rt/cmd_vel", twist);
    if (kind == "garbage") writer = peer.send(TypeSupport(new laconic_test::Short_PubSubType), "rt/cmd_vel", twist);
    Client client;
    DataReader *answers = nullptr;
    if (kind == "call") {
        const std::string type = "rcl_interfaces::srv::dds_::GetParameterTypes_";
        const std::string own = "laconic/get_parameter_types";
        answers = peer.hear(TypeSupport(new rcl_interfaces::srv::dds_::GetParameterTypes_Response_PubSubType),
                            ("rr/" + own + "Reply").c_str(), (type + "Response_").c_str(), client, 10);
        writer = peer.send(TypeSupport(new rcl_interfaces::srv::dds_::GetParameterTypes_Request_PubSubType),
                           ("rq/" + own + "Request").c_str(), (type + "Request_").c_str());
        client.own = answers->guid();
    }
    geometry_msgs::msg::dds_::Twist_ command;
    command.linear().x(std::atof(word[5]));
    command.angular().z(std::atof(word[6]));
    geometry_msgs::msg::dds_::TwistStamped_ with_stamp;
    with_stamp.twist(command);
    laconic_test::Short_ garbage;
    long sent = 0;
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) {
        garbage.text(std::string(sent % SHORTER_THAN_A_TWIST, (char)(sent % 251 + 1)));
        if (kind == "twist") writer->write(&command);
        if (kind == "stamped") writer->write(&with_stamp);
        PublicationMatchedStatus matched;
        if (kind == "call" && writer->get_publication_matched_status(matched) == ReturnCode_t::RETCODE_OK &&
            matched.current_count > 0)
            client.call(writer, client.sent);
        if (kind == "garbage") writer->write(&garbage);
        ++sent;
        std::this_thread::sleep_for(std::chrono::duration<double>(1.0 / per_second));
    }
    std::printf("{\n");
    odom.print("odom"), truth.print("ground_truth"), tf.print("tf"), fixed.print("tf_static");
    client.print();
    joints.print("joint_states"), imu.print("imu"), graph.print("ros_discovery_info");
    {
        std::lock_guard<std::mutex> guard(graph.lock);
        std::printf(" \"nodes\": [");
        const auto &nodes = graph.last.node_entities_info_seq();
        for (size_t k = 0; k < nodes.size(); ++k)
            std::printf("%s[\"%s\", \"%s\", %zu, %zu]", k ? ", " : "", nodes[k].node_namespace().c_str(),
                        nodes[k].node_name().c_str(), nodes[k].reader_gid_seq().size(),
                        nodes[k].writer_gid_seq().size());
        std::printf("],\n \"endpoints\": {");
    }
    {
        std::lock_guard<std::mutex> guard(peer.watch.lock);
        const char *comma = "";
        for (const auto &each : peer.watch.found) {
            std::printf("%s\"%s\": \"%s\"", comma, each.first.c_str(), each.second.c_str());
            comma = ", ";
        }
    }
    std::printf("},\n \"joint_names\": [");
    const auto &names = joints.last.name();
    for (size_t k = 0; k < names.size(); ++k) std::printf("%s\"%s\"", k ? ", " : "", names[k].c_str());
    std::printf("],\n");
    print_doubles("joint_velocity", joints.last.velocity());
    const auto &place = odom.last.pose().pose().position();
    const auto &speed = odom.last.twist().twist();
    print_doubles("odom_end", {place.x(), place.y(), speed.linear().x(), speed.angular().z()});
    print_doubles("imu_end", {imu.last.angular_velocity().z(), imu.last.linear_acceleration().z()});
    std::printf(" \"frames\": [\"%s\", \"%s\"],\n \"sent\": %ld\n}\n", odom.last.header().frame_id().c_str(),
                odom.last.child_frame_id().c_str(), sent);
    std::fflush(stdout);
    std::_Exit(0); /* without the seconds that Fast DDS takes to leave */
}
