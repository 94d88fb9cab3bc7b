// Records recorded.txt anew: reads its rows, ticks BehaviorTree.CPP's and Nav2's nodes, prints the rows.
//
//   g++ -std=c++17 -I BehaviorTree.CPP/include -I nav2_behavior_tree/include record.cpp
//       nav2_behavior_tree/plugins/control/{recovery_node,pipeline_sequence,nonblocking_sequence}.cpp
//       nav2_behavior_tree/plugins/control/{round_robin_node,persistent_sequence}.cpp
//       nav2_behavior_tree/plugins/decorator/single_trigger_node.cpp -lbehaviortree_cpp -o record
//   ./record < recorded.txt | diff recorded.txt -

#include <behaviortree_cpp/bt_factory.h>

#include <iostream>
#include <regex>
#include <sstream>

#include "nav2_behavior_tree/plugins/control/nonblocking_sequence.hpp"
#include "nav2_behavior_tree/plugins/control/persistent_sequence.hpp"
#include "nav2_behavior_tree/plugins/control/pipeline_sequence.hpp"
#include "nav2_behavior_tree/plugins/control/recovery_node.hpp"
#include "nav2_behavior_tree/plugins/control/round_robin_node.hpp"
#include "nav2_behavior_tree/plugins/decorator/single_trigger_node.hpp"

using namespace BT;

static std::string events;

static char letter(NodeStatus status)
{
  return status == NodeStatus::SKIPPED ? 'K' : toStr(status)[0];
}

// Returns the statuses of its script in turn, the last one for ever.
class Leaf : public ActionNodeBase
{
public:
  Leaf(const std::string& name, const NodeConfig& config) : ActionNodeBase(name, config) {}

  static PortsList providedPorts()
  {
    return { InputPort<std::string>("script"), InputPort<std::string>("index") };
  }

  NodeStatus tick() override
  {
    const auto script = getInput<std::string>("script").value();
    const char now = script[std::min(at_++, script.size() - 1)];
    events += getInput<std::string>("index").value() + now;
    return now == 'R' ? NodeStatus::RUNNING :
           now == 'S' ? NodeStatus::SUCCESS :
           now == 'F' ? NodeStatus::FAILURE :
                        NodeStatus::SKIPPED;
  }

  void halt() override
  {
    events += getInput<std::string>("index").value() + "!";
    resetStatus();
  }

private:
  size_t at_ = 0;
};

// The parent of the node under test: it can reset its child, and does nothing else.
class Probe : public ControlNode
{
public:
  Probe(const std::string& name, const NodeConfig& config) : ControlNode(name, config) {}
  static PortsList providedPorts() { return {}; }
  NodeStatus tick() override { return children_nodes_[0]->executeTick(); }
};

// `Type port=value … [kids]` as XML.
static std::string xml(const std::string& head, const std::string& kids)
{
  static const std::regex attribute(R"re((\w+)=(?:'([^']*)'|"([^"]*)"|(\S+)))re");
  std::string text = "<" + head.substr(0, head.find(' '));
  for(std::sregex_iterator it(head.begin(), head.end(), attribute), end; it != end; ++it)
  {
    const std::string value = (*it)[2].str() + (*it)[3].str() + (*it)[4].str();
    text += " " + (*it)[1].str() + "=\"" + std::regex_replace(value, std::regex(">"), "&gt;") + "\"";
  }
  text += ">";
  std::istringstream words(kids);
  std::string script;
  for(int index = 0; words >> script; index++)
  {
    text += "<Leaf script=\"" + script + "\" index=\"" + std::to_string(index) + "\"/>";
  }
  return text + "</" + head.substr(0, head.find(' ')) + ">";
}

static std::string watched(const Blackboard::Ptr& board, const std::string& type)
{
  const auto entry = board->getEntry(type == "PersistentSequence" ? "i" : "v");
  if(!entry || entry->value.empty())
  {
    return "/?";
  }
  const auto text = entry->value.cast<std::string>();
  if(type == "LoopBool")
  {
    return text == "1" ? "/true" : "/false";
  }
  return "/" + (type == "LoopDouble" ? std::regex_replace(text, std::regex("0+$"), "") : text);
}

int main()
{
  BehaviorTreeFactory factory;
  factory.registerNodeType<Leaf>("Leaf");
  factory.registerNodeType<Probe>("Probe");
  factory.registerNodeType<nav2_behavior_tree::RecoveryNode>("RecoveryNode");
  factory.registerNodeType<nav2_behavior_tree::PipelineSequence>("PipelineSequence");
  factory.registerNodeType<nav2_behavior_tree::NonblockingSequence>("NonblockingSequence");
  factory.registerNodeType<nav2_behavior_tree::RoundRobinNode>("RoundRobin");
  factory.registerNodeType<nav2_behavior_tree::PersistentSequenceNode>("PersistentSequence");
  factory.registerNodeType<nav2_behavior_tree::SingleTrigger>("SingleTrigger");
  const std::regex row(R"((\w.*?) \[(.*?)\] (.*))");
  std::smatch part;
  for(std::string line; std::getline(std::cin, line);)
  {
    if(!std::regex_match(line, part, row))
    {
      std::cout << line << "\n";
      continue;
    }
    const std::string head = part[1], kids = part[2], type = head.substr(0, head.find(' '));
    auto tree = factory.createTreeFromText("<root BTCPP_format=\"4\"><BehaviorTree ID=\"M\"><Probe>" +
                                           xml(head, kids) + "</Probe></BehaviorTree></root>");
    auto* probe = dynamic_cast<ControlNode*>(tree.rootNode());
    auto* node = const_cast<TreeNode*>(probe->children()[0]);
    std::cout << head << " [" << kids << "]";
    std::istringstream steps(part[3]);
    for(std::string step; steps >> step;)
    {
      events.clear();
      const auto write = step.find(":=");
      if(write != std::string::npos)
      {
        tree.rootBlackboard()->set(step.substr(0, write), step.substr(write + 2));
        std::cout << " " << step;
        continue;
      }
      if(step.find('~') != std::string::npos)
      {
        probe->haltChild(0);
        std::cout << " " << events << "~";
      }
      else
      {
        const auto status = letter(node->executeTick());
        std::cout << " " << events << "=" << status;
      }
      std::cout << (step.find('/') == std::string::npos ? "" : watched(tree.rootBlackboard(), type));
    }
    std::cout << "\n";
  }
}
